"""p50 and p99 of reads at a steady rate while a refit has every processor.

Reads come at fixed times whether the one before has been answered or not, and are timed from when they should have been
sent: a stall counts against every read that it delayed.

Usage: python3 tests/load/reads_during_refit.py SERVER [SECONDS]
"""

import json
import queue
import sys
import threading
import time

from common import Service, quantile

RATE = 200
WORKERS = 32


def main(program, seconds):
    with Service(program, limits_writes_per_second=0) as service:
        digest = service.digest("ggx-isotropic")
        paths = [
            f"/v1/tables/ggx-isotropic/versions/{digest}/data",
            "/v1/tables",
            "/v1/tables/ggx-anisotropic/versions/latest",
            "/v1/tables/ggx-anisotropic/versions/latest/lookup?theta=0.5&phi=1&alpha_x=0.4&alpha_y=0.1",
            f"/v1/tables/ggx-isotropic/versions/{digest}/data?format=ktx2&precision=f16",
        ]
        report("at rest", measure(service, paths, seconds / 2), 0.0)
        status, body = service.write("POST", "/v1/refits", {"preset": "ggx-anisotropic", "spec": {"joint": {"seed": 9, "steps": 6000}}})
        assert status == 202, body
        refit = "/v1/refits/" + json.loads(body)["id"]
        while json.loads(service.ask("GET", refit)[1])["state"] == "queued":
            time.sleep(0.1)
        time.sleep(2)
        before, start = service.cpu_seconds(), time.monotonic()
        times = measure(service, paths, seconds)
        busy = (service.cpu_seconds() - before) / (time.monotonic() - start)
        now = json.loads(service.ask("GET", refit)[1])
        assert now["state"] == "running", f"the refit was too short: {now['state']}"
        report("during a refit", times, busy)
        service.write("DELETE", refit, None)
        worst = quantile(times, 0.99)
        if worst > 0.05:
            sys.exit(f"p99 is {worst * 1e3:.1f} ms, more than 50 ms")


def report(when, times, processors):
    figures = [quantile(times, share) * 1e3 for share in (0.5, 0.9, 0.99, 1.0)]
    with open("/proc/loadavg", encoding="ascii") as file:
        load = file.read().split()[0]
    print(
        f"{when}: {len(times)} reads at {RATE}/s; p50 {figures[0]:.2f} ms, p90 {figures[1]:.2f} ms, p99 {figures[2]:.2f} ms, "
        f"max {figures[3]:.2f} ms; the service used {processors:.2f} processors; load average {load}",
        flush=True,
    )


def measure(service, paths, seconds):
    due, times, faults = queue.Queue(), [], []

    def work():
        connection = service.connect()
        while (item := due.get()) is not None:
            at, path = item
            connection.request("GET", path)
            answer = connection.getresponse()
            answer.read()
            times.append(time.monotonic() - at)
            if answer.status != 200:
                faults.append((path, answer.status))
        connection.close()

    threads = [threading.Thread(target=work) for _ in range(WORKERS)]
    for thread in threads:
        thread.start()
    start = time.monotonic()
    for i in range(int(seconds * RATE)):
        at = start + i / RATE
        time.sleep(max(0.0, at - time.monotonic()))
        due.put((at, paths[i % len(paths)]))
    for _ in threads:
        due.put(None)
    for thread in threads:
        thread.join()
    assert not faults, faults[:5]
    return times


main(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 30.0)
