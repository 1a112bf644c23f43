"""Malformed requests, as bytes on the wire: no 5xx, nothing written, memory flat.

Each is a good request with bytes of it changed, cut out, doubled or put in, on a connection of its own. Among the good ones are
writes without a token. Ends with an error at a status of 5xx, at a write that was taken, or at memory that grows by more than 5 %
from a tenth of the requests to the last.

Usage: python3 tests/load/malformed.py SERVER [COUNT]
"""

import random
import socket
import sys
from concurrent.futures import ThreadPoolExecutor

from common import Service

GROWTH = 0.05
CLIENTS = 16
# Seconds to wait for an answer.
PATIENCE = 0.5


def good(digest):
    data = f"/v1/tables/ggx-isotropic/versions/{digest}/data"
    lookup = "/v1/tables/ggx-anisotropic/versions/latest/lookup"
    query = '[{"theta": 0.5, "phi": 1, "alpha_x": 0.3, "alpha_y": 0.1}]'
    bodies = [
        ("POST", lookup, query),
        ("POST", "/v1/refits", '{"preset": "ggx-isotropic", "spec": {"joint": {"steps": 10}}}'),
        ("POST", "/v1/benchmarks", '{"name": "a", "run": {"b": 1}}'),
        ("PUT", "/v1/tables/ggx-isotropic/aliases/stable", '{"version": 1}'),
        ("POST", "/v1/tables/ggx-isotropic/versions", "--x\r\nContent-Disposition: form-data; name=\"manifest\"\r\n\r\n{}\r\n--x--\r\n"),
        ("DELETE", "/v1/refits/00000000000000000000000000000000", ""),
    ]
    for path in [data, f"{data}?format=ktx2&precision=f16&alpha=0.1..0.5", f"{lookup}?theta=0.5&alpha_x=0.2&alpha_y=0.2", "/v1/tables", "/benchmarks?measure=a"]:
        headers = f'Range: bytes=0-99\r\nIf-None-Match: "{digest}"\r\nAccept-Encoding: gzip;q=0.5\r\nX-Request-Id: a\r\n'
        yield f"GET {path} HTTP/1.1\r\nHost: a\r\nConnection: close\r\n{headers}\r\n".encode()
    for method, path, body in bodies:
        kind = "multipart/form-data; boundary=x" if path.endswith("/versions") else "application/json"
        head = f"{method} {path} HTTP/1.1\r\nHost: a\r\nConnection: close\r\nContent-Type: {kind}\r\nContent-Length: {len(body)}\r\n\r\n"
        yield (head + body).encode()


def spoilt(rng, request):
    bytes_ = bytearray(request)
    for _ in range(rng.choice([1, 1, 2, 5, 20])):
        at = rng.randrange(len(bytes_))
        match rng.randrange(4):
            case 0:
                bytes_[at] = rng.randrange(256)
            case 1:
                del bytes_[at : at + rng.randrange(1, 30)]
            case 2:
                bytes_[at:at] = bytes_[at : at + rng.randrange(1, 60)]
            case _:
                bytes_[at:at] = rng.choice([b"\0", b"\r\n", b"%", b"%ff", b"\xff\xfe", b"'\"<", b"../", b"99999999999999999999", b"NaN", b"-"])
        if not bytes_:
            return b"\r\n"
    return bytes(bytes_)


def status_of(host, request):
    address, port = host.split(":")
    with socket.create_connection((address, int(port)), timeout=PATIENCE) as connection:
        try:
            connection.sendall(request)
            answer = b""
            while len(answer) < 12 and (more := connection.recv(4096)):
                answer += more
        except OSError:
            # Something is missing, for which the service waits longer than we do, or it has closed.
            return "unanswered"
    return int(answer[9:12]) if answer.startswith(b"HTTP/1.") else "unanswered"


def main(program, count):
    rng = random.Random(5)
    with Service(program) as service:
        requests = list(good(service.digest("ggx-isotropic")))
        before = [service.ask("GET", path)[1] for path in ("/v1/tables", "/v1/refits", "/v1/benchmarks")]
        statuses, early = {}, 0
        with ThreadPoolExecutor(CLIENTS) as clients:
            spoilt_ones = [spoilt(rng, rng.choice(requests)) for _ in range(count)]
            for i, status in enumerate(clients.map(lambda request: status_of(service.host, request), spoilt_ones)):
                statuses[status] = statuses.get(status, 0) + 1
                if i == count // 10:
                    early = service.memory()
        late = service.memory()
        after = [service.ask("GET", path)[1] for path in ("/v1/tables", "/v1/refits", "/v1/benchmarks")]
        print(f"statuses {dict(sorted(statuses.items(), key=str))}")
        print(f"memory {early / 2**20:.1f} MiB after {count // 10} requests, {late / 2**20:.1f} MiB after {count}: {late / early - 1:+.1%}")
        faults = [status for status in statuses if isinstance(status, int) and status >= 500]
        if faults or before != after or late / early - 1 > GROWTH:
            sys.exit(f"not well: statuses {faults}, something written: {before != after}")


main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 10_000)
