"""Time from a slider's change to the new picture on the page of `granchain explore`, in chromium.

``python tests/benchmarks/explore_latency.py [SCENE [NUMBER]]`` changes a number of a scene ten times, by default the
coupling stiffness of ``two-chains``, and prints each time and the part of it that the computation took.
"""

import os
import re
import shutil
import statistics
import subprocess
import sys

from playwright.sync_api import sync_playwright

import granchain
from lammps_inputs.numbers import time_text
from workflow.sweep import fields

CHANGES = 10

COMPUTED = "Bokeh.documents[0].get_model_by_name('status').text.includes('computed in')"

CHANGED = """async ([name, value]) => {
  const [slider, image, status] = [name, 'chain-1', 'status'].map(one => Bokeh.documents[0].get_model_by_name(one));
  const started = performance.now();
  const received = new Promise(resolve => image.properties.data.change.connect(resolve));
  slider.value = value;
  await received;
  await new Promise(resolve => requestAnimationFrame(() => setTimeout(resolve)));  // it is drawn
  return [(performance.now() - started) / 1000, status.text];
}"""


def main(scene: str = "two-chains", number: str = "coupling.stiffness") -> int:
    """Print the time of every change, and their median and largest."""
    value = fields.look_up(granchain.load(scene).plain(), fields.parse(number))
    command = [sys.executable, "-m", "workflow", "explore", scene, "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server, sync_playwright() as driver:
        assert server.stdout is not None
        address = server.stdout.readline().split()[-1]
        started = driver.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        page = started.new_page(viewport={"width": 1280, "height": 1400})
        page.goto(address)
        page.wait_for_function(f"window.Bokeh && Bokeh.documents.length && {COMPUTED}", timeout=120_000)
        page.wait_for_timeout(2000)
        times = []
        for change in range(1, CHANGES + 1):
            seconds, status = page.evaluate(CHANGED, [f"slider {number}", value * (1.0 + 0.01 * change)])
            times.append(seconds)
            (computed,) = re.findall(r"computed in ([\d.]+ \w+)", status) or ["-"]
            print(
                f"{number} {value * (1.0 + 0.01 * change):.4g}: {time_text(seconds)}, of which computed in {computed}"
            )
            page.wait_for_timeout(500)
        started.close()
        server.terminate()
    print(f"median {time_text(statistics.median(times))}, largest {time_text(max(times))}", end="; ")
    print(f"load of the machine {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
