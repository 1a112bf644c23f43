"""A service of one's own, for the scripts in this folder."""

import http.client
import json
import os
import subprocess
import tempfile


class Service:
    """A process that serves a fresh store, with a token for everything."""

    def __init__(self, program, **settings):
        self.folder = tempfile.TemporaryDirectory()
        token_file = os.path.join(self.folder.name, "token")
        environment = os.environ | {
            "LTC_LISTEN": "127.0.0.1:0",
            "LTC_DATA": os.path.join(self.folder.name, "data"),
            "LTC_LOG": "warn",
            "TOKEN_FILE": token_file,
            # As the unit in deploy/ has it.
            "MALLOC_ARENA_MAX": "2",
        }
        environment |= {f"LTC_{name.upper()}": str(value) for name, value in settings.items()}
        self.process = subprocess.Popen([program], env=environment, stdout=subprocess.PIPE, text=True)
        self.host = self.process.stdout.readline().strip().removeprefix("http://")
        with open(token_file, encoding="ascii") as file:
            self.token = file.read()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(30)
        self.folder.cleanup()

    def connect(self):
        return http.client.HTTPConnection(self.host, timeout=30)

    def ask(self, method, path, body=None, headers=None):
        """Status and body of a request of its own connection."""
        connection = self.connect()
        try:
            connection.request(method, path, body, headers or {})
            answer = connection.getresponse()
            return answer.status, answer.read()
        finally:
            connection.close()

    def write(self, method, path, value):
        headers = {"Content-Type": "application/json", "Authorization": f"Bearer {self.token}"}
        return self.ask(method, path, json.dumps(value), headers)

    def digest(self, table):
        return json.loads(self.ask("GET", f"/v1/tables/{table}")[1])["digest"]

    def memory(self):
        """Resident bytes."""
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as file:
            line = next(line for line in file if line.startswith("VmRSS"))
        return int(line.split()[1]) * 1024

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def cpu_seconds(self):
        with open(f"/proc/{self.process.pid}/stat", encoding="ascii") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def quantile(times, share):
    ordered = sorted(times)
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)]


