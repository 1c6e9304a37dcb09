#!/usr/bin/env python3
"""Pictures of turbid's path tracer against those of Mitsuba 3, scene by scene.

    pip install mitsuba numpy
    python3 tests/mitsuba/compare.py target/release/turbid

Every scene of tests/mitsuba/scenes is exported, rendered by both programs, and compared: the mean of the picture by channel and
the means of 4 x 4 blocks. It is read back too (`turbid import`), and the picture of what came back is compared with Mitsuba's.
The error of turbid is its own (`variance.R` of its EXR files), that of Mitsuba is the spread of independent renders. A difference
of 5 standard errors or more, of a mean or of a block, fails. "detects" is the smallest difference of the mean that would have
failed in 99 of 100 runs, (5 + 2.4) standard errors, of the channel where it is largest.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile

import mitsuba as mi
import numpy as np

REPLICATES = 64
LIMIT = 5.0
BLOCKS = 4
SCENES = pathlib.Path(__file__).parent / "scenes"


def run(*arguments):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, arguments))}\n{done.stderr}")


def channels(path, prefix):
    bitmap = mi.Bitmap(str(path))
    names = [field.name for field in bitmap.struct_()]
    wanted = [names.index(prefix + channel) for channel in "RGB"]
    return np.array(bitmap)[:, :, wanted].astype(float)


def parts(picture):
    """The mean of the picture, then those of its blocks, by channel."""
    blocks = [
        block.mean(axis=(0, 1))
        for row in np.array_split(picture, BLOCKS, axis=0)
        for block in np.array_split(row, BLOCKS, axis=1)
    ]
    return np.array([picture.mean(axis=(0, 1))] + blocks)


def variances(variance):
    """Variances of the same means, from those of independent pixels."""
    counts = parts(np.ones_like(variance)) * 0
    counts[0] = variance.shape[0] * variance.shape[1]
    rows = [len(r) for r in np.array_split(np.arange(variance.shape[0]), BLOCKS)]
    columns = [len(c) for c in np.array_split(np.arange(variance.shape[1]), BLOCKS)]
    counts[1:] = np.array([r * c for r in rows for c in columns])[:, None]
    return parts(variance) / counts


def by_turbid(turbid, scene, samples, folder):
    picture = folder / "turbid.exr"
    run(turbid, "render", scene, "-o", picture, "--with", "paths", "--samples", samples, "--seed", 7)
    return parts(channels(picture, "")), variances(channels(picture, "variance."))


def by_mitsuba(scene, samples):
    loaded = mi.load_file(str(scene), spp=max(1, samples // REPLICATES))
    means = np.array([parts(np.array(mi.render(loaded, seed=seed)).astype(float)) for seed in range(REPLICATES)])
    return means.mean(axis=0), means.var(axis=0, ddof=1) / REPLICATES


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("turbid", type=pathlib.Path, help="the program")
    arguments.add_argument("--exporter", type=pathlib.Path, help="another build of it, for export and import")
    arguments.add_argument("--scale", type=float, default=1.0, help="samples, times those of the test")
    arguments.add_argument("--only", help="one scene, by its name")
    arguments.add_argument("--no-import", action="store_true", help="leave out what is read back")
    given = arguments.parse_args()
    turbid = given.turbid.resolve()
    exporter = (given.exporter or given.turbid).resolve()
    mi.set_variant("scalar_rgb")
    failed = 0
    print(f"{'scene':22} {'turbid':>9} {'Mitsuba':>9} {'z':>6} {'detects':>8} {'worst z of a block':>18} {'read back: z':>13} {'worst':>6}")
    for scene in sorted(SCENES.glob("*.toml")):
        if given.only and scene.stem != given.only:
            continue
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            xml, again = folder / f"{scene.stem}.xml", folder / "again.toml"
            run(exporter, "export", scene, "--mitsuba", xml)
            samples = max(REPLICATES, int(512 * given.scale))
            theirs, their_variance = by_mitsuba(xml, samples)
            told = []
            pictures = [scene]
            if not given.no_import:
                run(exporter, "import", xml, "-o", again)
                pictures.append(again)
            for picture in pictures:
                ours, our_variance = by_turbid(turbid, picture, samples, folder)
                error = np.sqrt(our_variance + their_variance)
                z = np.divide(ours - theirs, error, out=np.zeros_like(error), where=error > 0)
                z[(error == 0) & (ours != theirs)] = np.inf
                mean = np.abs(z[0]).argmax()
                told.append((z[0, mean], z[1:].flat[np.abs(z[1:]).argmax()]))
                detects = (LIMIT + 2.4) * (error[0] / theirs[0]).max()
                failed += bool((np.abs(z) >= LIMIT).any())
                if len(told) == 1:
                    line = f"{scene.stem:22} {ours[0].mean():9.5f} {theirs[0].mean():9.5f} {told[0][0]:6.2f} {100 * detects:6.2f} % {told[0][1]:18.2f}"
            if len(told) > 1:
                line += f" {told[1][0]:13.2f} {told[1][1]:6.2f}"
            print(line, flush=True)
    if failed:
        print(f"{failed} pictures differ by {LIMIT} standard errors or more")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
