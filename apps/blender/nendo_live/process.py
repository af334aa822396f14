"""A run of nendo that the add-on starts. Needs nothing of Blender. No function waits."""
import os
import re
import shlex
import shutil
import signal
import subprocess
import tempfile

_ADDRESS = re.compile(r"http://\S+")
_LOG_TAIL = 4096


def command(program, mesh, name, out, options):
    """The command line. `options` has left, right, left_wrist, right_wrist (each GLOVE, TRACKER or empty), more (as typed in a
    shell) and web (whether a browser may control the run). Raises ValueError for unbalanced quotes."""
    words = [program, "run", "--mesh", mesh, "--to", f"shm:{name}", "--out", out, "--force"]
    for option in ("left", "right", "left_wrist", "right_wrist"):
        if options.get(option):
            words += ["--" + option.replace("_", "-"), options[option]]
    if options.get("web"):
        words += ["--web", "0"]
    return words + shlex.split(options.get("more", ""))


class Run:
    """Starts a command in a folder of its own. It ends with Blender, even if Blender is killed. Raises OSError."""

    def __init__(self, make_command):
        """make_command(folder) returns the words."""
        self._folder = tempfile.TemporaryDirectory(prefix="nendo-blender-")
        try:
            words = make_command(self.folder)
            if shutil.which(words[0]) is None:
                raise FileNotFoundError(f"{words[0]}: there is no such program; install Nendo, or set its path in the preferences")
            if shutil.which("setpriv"):
                words = ["setpriv", "--pdeathsig", "INT", *words]
            self._log = open(os.path.join(self.folder, "log"), "w+b")
            self._process = subprocess.Popen(words, cwd=self.folder, stdin=subprocess.DEVNULL, stdout=self._log,
                                             stderr=subprocess.STDOUT)
        except BaseException:
            self._folder.cleanup()
            raise

    @property
    def folder(self):
        return self._folder.name

    def exit_code(self):
        """None while it runs."""
        return self._process.poll()

    def stop(self):
        """Asks it to end, as Ctrl-C does."""
        if self.exit_code() is None:
            self._process.send_signal(signal.SIGINT)

    def end(self):
        """Asks it to end, and removes its folder without waiting."""
        self.stop()
        self.clean_up()

    def clean_up(self):
        self._log.close()
        self._folder.cleanup()

    def _text(self, begin):
        if self._log.closed:
            return ""
        return os.pread(self._log.fileno(), _LOG_TAIL, max(0, begin)).decode(errors="replace")

    def address(self):
        """Where a browser controls the run; empty if it does not."""
        found = _ADDRESS.search(self._text(0))
        return found[0] if found else ""

    def last_line(self):
        """What it wrote last, for a message."""
        size = 0 if self._log.closed else os.fstat(self._log.fileno()).st_size
        lines = [line.strip() for line in self._text(size - _LOG_TAIL).splitlines() if line.strip()]
        return "".join(c for c in lines[-1] if c.isprintable()) if lines else "it wrote no message"
