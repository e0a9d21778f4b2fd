"""Settings of all tests."""

import os
import signal

from hypothesis import HealthCheck, settings

# a busy machine is no failure
settings.register_profile(
    "granchain",
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    derandomize=bool(os.environ.get("CI")),  # chance finds are for those who can look into them
)
settings.load_profile("granchain")

# a shell starts what runs in its background with Ctrl-C ignored, and so would be all that the tests start
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
