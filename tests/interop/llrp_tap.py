"""A TCP proxy that keeps the frames of both directions, for the scripts beside."""
import json
import socket
import threading


class Tap:
    """Listens on a free port of 127.0.0.1 and passes one connection on to (host, port)."""

    def __init__(self, host, port):
        self.target = (host, port)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.lock = threading.Lock()
        self.pending = {"client": b"", "reader": b""}
        self.frames = []  # [who said it, hex]
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        while True:
            client, _ = self.listener.accept()
            reader = socket.create_connection(self.target)
            for name, source, sink in (("client", client, reader), ("reader", reader, client)):
                threading.Thread(target=self._pass, args=(name, source, sink), daemon=True).start()

    def _pass(self, name, source, sink):
        while True:
            try:
                data = source.recv(65536)
                if data:
                    self._keep(name, data)
                    sink.sendall(data)
                    continue
            except OSError:
                pass
            for s in (source, sink):
                try:
                    s.shutdown(socket.SHUT_RDWR)
                except OSError:
                    pass
            return

    def _keep(self, name, data):
        with self.lock:
            stream = self.pending[name] + data
            while len(stream) >= 10 and len(stream) >= int.from_bytes(stream[2:6], "big"):
                length = int.from_bytes(stream[2:6], "big")
                self.frames.append([name, stream[:length].hex()])
                stream = stream[length:]
            self.pending[name] = stream

    def write(self, path):
        with self.lock, open(path, "w") as file:
            json.dump(self.frames, file)
