"""Settings of all tests."""

import os

from hypothesis import HealthCheck, settings

# a busy machine is no failure
settings.register_profile(
    "granchain",
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    derandomize=bool(os.environ.get("CI")),  # chance finds are for those who can look into them
)
settings.load_profile("granchain")
