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
        # Nothing but what the settings say: what is measured is what a user gets.
        environment = {name: value for name, value in os.environ.items() if not name.startswith(("LTC_", "MALLOC_"))}
        environment |= {
            "LTC_LISTEN": "127.0.0.1:0",
            "LTC_DATA": os.path.join(self.folder.name, "data"),
            "LTC_LOG": "warn",
            "TOKEN_FILE": token_file,
        }
        environment |= {f"LTC_{name.upper()}": str(value) for name, value in settings.items()}
        command = [program]
        if os.path.basename(program) == "ltc":
            # The example makes a token by itself.
            command = [program, "serve"]
            scopes = ["token", "create", "--data", environment["LTC_DATA"], "--scope", "refit,publish,benchmark"]
            with open(token_file, "w", encoding="ascii") as file:
                subprocess.run([program, *scopes], check=True, stdout=file, stderr=subprocess.DEVNULL)
        self.process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
        self.host = self.process.stdout.readline().strip().rsplit("http://", 1)[1]
        with open(token_file, encoding="ascii") as file:
            self.token = file.read().strip()

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

    def cached(self):
        """Bytes that the service holds in its caches on purpose."""
        lines = self.ask("GET", "/metrics")[1].decode().splitlines()
        return sum(float(line.rsplit(" ", 1)[1]) for line in lines if line.startswith("ltc_memory_cache_bytes{"))

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def cpu_seconds(self):
        with open(f"/proc/{self.process.pid}/stat", encoding="ascii") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def quantile(times, share):
    ordered = sorted(times)
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)]


