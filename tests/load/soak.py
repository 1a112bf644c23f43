"""Mixed load for as long as one likes: growth of memory and file descriptors.

Reads of every kind, lookups, writes (benchmark runs, aliases), refits asked for and cancelled, malformed requests and connections
that break off. Ends with an error at a status of 5xx other than 503, at descriptors that grow or are not given back, or at memory that grows
by more than 5 % from the second fifth of the time to the last (medians of the resident set, read every two seconds). The first fifth
is the time in which the caches fill, whose bounds are settings: how much is in them is printed beside the memory, and grows no
more afterwards.

Usage: python3 tests/load/soak.py SERVER SECONDS
"""

import http.client
import json
import os
import random
import socket
import statistics
import struct
import sys
import threading
import time

from common import Service

CLIENTS = 8
# Between two requests of a client, seconds: a few hundred requests a second leave a machine usable for hours.
PAUSE = float(os.environ.get("PAUSE", "0.02"))
GROWTH = 0.05
# Of the embedded store: one that writes and four that read.
STORE_CONNECTIONS = 5


class Counts:
    def __init__(self):
        self.lock, self.statuses = threading.Lock(), {}

    def add(self, status):
        with self.lock:
            self.statuses[status] = self.statuses.get(status, 0) + 1


def client(service, seed, until, counts):
    rng = random.Random(seed)
    digest = service.digest("ggx-isotropic")
    data = f"/v1/tables/ggx-isotropic/versions/{digest}/data"
    connection = service.connect()
    headers = {"Authorization": f"Bearer {service.token}", "Content-Type": "application/json"}

    def ask(method, path, body=None, more=None):
        nonlocal connection
        try:
            connection.request(method, path, body, (more or {}))
            answer = connection.getresponse()
            answer.read()
            counts.add(answer.status)
        except (OSError, http.client.HTTPException):
            # The service closes a connection on which something came that is no request.
            counts.add("closed")
            connection.close()
            connection = service.connect()

    def malformed():
        junk = "".join(rng.choice("%/?&=.:@ab01\\<>\"'{}[]") for _ in range(rng.randint(1, 60)))
        ask(rng.choice(["GET", "POST", "PUT", "DELETE"]), "/v1/" + junk, rng.choice([None, "{", "[1,2", "\x00"]), headers if rng.random() < 0.3 else {})

    def broken():
        host, port = service.host.split(":")
        with socket.create_connection((host, int(port)), timeout=10) as raw:
            raw.sendall(rng.choice([b"GET /v1/tab", b"POST /v1/benchmarks HTTP/1.1\r\nhost: a\r\ncontent-length: 100\r\n\r\n{", b"\x16\x03\x01"]))
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))

    def refit():
        spec = {"preset": "disney-diffuse", "spec": {"measure": {"seed": rng.randint(1, 10**9)}}}
        status, body = service.write("POST", "/v1/refits", spec)
        counts.add(status)
        if status == 202:
            time.sleep(0.2)
            counts.add(service.write("DELETE", "/v1/refits/" + json.loads(body)["id"], None)[0])

    def query():
        theta, alpha = rng.uniform(0, 1.5), rng.uniform(0.01, 1)
        return {"theta": theta, "phi": rng.uniform(-7, 7), "alpha_x": alpha, "alpha_y": alpha * rng.uniform(0.1, 1)}

    anisotropic = "/v1/tables/ggx-anisotropic/versions/latest/lookup"
    actions = [
        (30, lambda: ask("GET", data)),
        (10, lambda: ask("GET", data, None, {"If-None-Match": f'"{digest}"'})),
        (10, lambda: ask("GET", data, None, {"Range": f"bytes={rng.randint(0, 1000)}-{rng.randint(1000, 9000)}"})),
        (10, lambda: ask("GET", rng.choice(["/", "/v1/tables", "/metrics", "/docs", "/openapi.json", "/v1/refits", "/readyz"]), None, {"Accept-Encoding": "gzip"})),
        (10, lambda: ask("GET", f"{data}?format=json&precision=f32&alpha={rng.uniform(0.1, 0.4):.6f}..{rng.uniform(0.5, 0.9):.6f}", None, {"Accept-Encoding": "gzip"})),
        (10, lambda: ask("POST", anisotropic, json.dumps([query() for _ in range(100)]), {"Content-Type": "application/json"})),
        (10, malformed),
        (2, broken),
        (2, lambda: ask("POST", "/v1/benchmarks", json.dumps({"name": "soak", "run": {"a": rng.random()}}), headers)),
        (2, lambda: ask("PUT", "/v1/tables/ggx-isotropic/aliases/soak", json.dumps({"version": rng.randint(1, 2)}), headers | {"If-Match": "*"})),
        (1, refit),
    ]
    weights = [weight for weight, _ in actions]
    while time.monotonic() < until:
        rng.choices(actions, weights)[0][1]()
        time.sleep(PAUSE)
    connection.close()


def main(program, seconds):
    with Service(program, limits_derived_bytes=32 << 20) as service:
        service.ask("PUT", "/v1/tables/ggx-isotropic/aliases/soak", json.dumps({"version": 1}), {
            "Authorization": f"Bearer {service.token}", "Content-Type": "application/json", "If-None-Match": "*",
        })
        counts, start = Counts(), time.monotonic()
        at_rest = service.descriptors()
        threads = [threading.Thread(target=client, args=(service, seed, start + seconds, counts)) for seed in range(CLIENTS)]
        for thread in threads:
            thread.start()
        samples, cached, shown = [], [], 0.0
        while any(thread.is_alive() for thread in threads):
            time.sleep(2)
            samples.append((time.monotonic() - start, service.memory(), service.descriptors()))
            if samples[-1][0] >= shown:
                shown += seconds / 40
                cached.append((samples[-1][0], service.cached()))
                asked = sum(counts.statuses.values())
                print(
                    f"{samples[-1][0]:7.0f} s  {samples[-1][1] / 2**20:7.1f} MiB, {cached[-1][1] / 2**20:5.1f} of them in caches  "
                    f"{samples[-1][2]:4d} descriptors  {asked:8d} requests",
                    flush=True,
                )
        time.sleep(2)
        after = service.descriptors()

        def median(values, low, high):
            chosen = [value for at, value, *_ in values if low * seconds <= at <= high * seconds]
            return statistics.median(chosen)

        early, late = median(samples, 0.2, 0.4), median(samples, 0.8, 1.0)
        open_ones = [(at, descriptors) for at, _, descriptors in samples]
        few, many = median(open_ones, 0.2, 0.4), median(open_ones, 0.8, 1.0)
        growth = late / early - 1
        most = max(descriptors for _, _, descriptors in samples)
        with open("/proc/loadavg", encoding="ascii") as file:
            load = file.read().split()[0]
        known = {str(status): count for status, count in counts.statuses.items()}
        print(f"statuses {dict(sorted(known.items()))}; load average {load}")
        print(f"in caches {median(cached, 0.2, 0.4) / 2**20:.1f} MiB in the second fifth, {median(cached, 0.8, 1.0) / 2**20:.1f} in the last")
        print(
            f"memory {early / 2**20:.1f} MiB in the second fifth, {late / 2**20:.1f} in the last: {growth:+.1%}; "
            f"descriptors {few:.0f} and {many:.0f}, {most} at most; {at_rest} before, {after} after"
        )
        faults = [status for status in counts.statuses if isinstance(status, int) and status >= 500 and status != 503]
        # Each of the store's connections opens the log of the database when it is first used, and keeps it.
        if faults or growth > GROWTH or many > few + 2 or after > at_rest + STORE_CONNECTIONS:
            sys.exit(f"not steady: statuses {faults}, growth {growth:.1%}, descriptors {few:.0f} to {many:.0f}, {at_rest} to {after}")


main(sys.argv[1], float(sys.argv[2]))
