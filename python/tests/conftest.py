"""What the tests share: the programs that numbers are compared with."""

import json
import os
import pathlib
import signal
import subprocess

import pytest

FOLDER = pathlib.Path(os.environ.get("TURBID_PROGRAMS", pathlib.Path(__file__).parents[2] / "target" / "release"))


class Program:
    """A program of the main workspace."""

    def __init__(self, name):
        self.path = FOLDER / name
        assert self.path.exists(), f"{self.path} is not there: python/check builds it"

    def run(self, *words, cwd=None):
        words = [str(word) for word in words]
        return subprocess.run([str(self.path), *words], capture_output=True, text=True, cwd=cwd)

    def json(self, *words, cwd=None):
        done = self.run(*words, "--format", "json", cwd=cwd)
        assert done.returncode == 0, done.stderr
        answer = json.loads(done.stdout)
        # `measure` says beside its rows what they were made with.
        return answer["rows"] if isinstance(answer, dict) and "run" in answer else answer

    def error(self, *words, cwd=None):
        """The text of its error, without its name."""
        done = self.run(*words, cwd=cwd)
        assert done.returncode == 2, (done.stdout, done.stderr)
        return done.stderr.strip().split("error: ", 1)[1]


@pytest.fixture(scope="session")
def exact_program():
    return Program("exact")


@pytest.fixture(scope="session")
def turbid_program():
    return Program("turbid")


@pytest.fixture
def interruptible():
    """Starts programs that Ctrl-C reaches, also where a shell in the background has it ignored; none outlives the test."""
    children = []

    def start(words):
        def heed():
            signal.signal(signal.SIGINT, signal.SIG_DFL)

        child = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=heed)
        children.append(child)
        return child

    yield start
    for child in children:
        child.kill()
        child.wait()
