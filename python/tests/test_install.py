# SPDX-License-Identifier: Apache-2.0
"""What is installed: its metadata, licences and example scenes, and what becomes of
it beside PyPI's distribution `drape`, which is another project."""

from __future__ import annotations

import json
import platform
import re
import subprocess
import sys
import zipfile
from importlib.metadata import distribution
from pathlib import Path

import pytest
from conftest import ROOT
from needs import need

import drape
from drape import examples

WHEELS = sorted((ROOT / "dist").glob("drape_cloth-*.whl"))
needs_wheel = pytest.mark.skipif(
    len(WHEELS) != 1, reason="there is no wheel in dist: make wheel"
)


def test_its_metadata() -> None:
    about = distribution("drape-cloth").metadata
    assert drape.__version__ == about["Version"]
    assert about["Author"] and "cloth" in about["Keywords"].split(",")
    for extra in ("ray", "s3"):
        needs = f'drape-cloth[sweep]; extra == "{extra}"'
        assert needs in (about.get_all("Requires-Dist") or [])
    cited = (ROOT / "CITATION.cff").read_text()
    version = re.search(r"^version: (.+)$", cited, re.MULTILINE)
    assert version and version[1] == drape.__version__.partition("+")[0]
    address = re.search(r'^repository-code: "?([^\s"]+)', cited, re.MULTILINE)
    listed = about.get_all("Project-URL") or []
    assert any(address[1] in each for each in listed) if address else not listed


def test_the_recipe_for_conda() -> None:
    """rattler-build understands it, and it says what the package says of itself."""
    build = need("rattler_build")
    chosen = {"c_compiler": ["gcc"], "cxx_compiler": ["gxx"], "c_stdlib": ["sysroot"]}
    recipe = build.Stage0Recipe.from_file(str(ROOT / "ci/conda/recipe.yaml"))
    [made] = recipe.render(build.VariantConfig(chosen))
    found = made.recipe.to_dict()
    about = distribution("drape-cloth").metadata
    assert found["package"]["name"] == about["Name"]
    assert found["package"]["version"] == about["Version"].partition("+")[0]
    assert found["about"]["license"] == about["License-Expression"]
    assert found["about"]["summary"] == about["Summary"]
    needs = [each for each in about.get_all("Requires-Dist") or [] if ";" not in each]
    listed = sorted(each.replace(" ", "") for each in found["requirements"]["run"])
    assert listed == sorted([*needs, f"python{about['Requires-Python']}"])
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    hosts = {each.replace(" ", "") for each in found["requirements"]["host"]}
    assert hosts >= set(re.findall(r'"(\S+>=\S+)"', project))


@needs_wheel
def test_its_name_says_for_which_glibc_it_is() -> None:
    """auditwheel, which has named it, finds the same of what is in it now."""
    auditwheel = ROOT / "build/python/venv/bin/auditwheel"
    if not auditwheel.exists():
        pytest.skip(f"there is no {auditwheel}: make wheel")
    told = subprocess.check_output([auditwheel, "show", WHEELS[0]], text=True)
    tag = re.search(r'following\s+platform\s+tag:\s+"(\w+)"', told)
    assert tag, told
    name = f"drape_cloth-{drape.__version__}-cp310-abi3-{tag[1]}.whl"
    assert WHEELS[0].name == name
    if platform.libc_ver() == ("glibc", "2.36"):  # Debian 12, of which README tells
        assert tag[1].startswith("manylinux_2_34_")


@needs_wheel
def test_each_library_has_its_licence() -> None:
    with zipfile.ZipFile(WHEELS[0]) as wheel:
        names = set(wheel.namelist())
        [info] = {n.split("/")[0] for n in names if ".dist-info/" in n}
        libraries = [n for n in names if ".libs/" in n and not n.endswith("/")]
        parts = json.loads(wheel.read(f"{info}/sboms/auditwheel.cdx.json"))
        packages = {
            part["name"]
            for part in parts["components"]
            if part["purl"].startswith("pkg:deb/")
        }
        assert len(packages) == len(libraries) > 0
        files = [f"{package}/copyright" for package in packages]
        texts = [wheel.read(f"{info}/licenses/{name}").decode() for name in files]
        metadata = wheel.read(f"{info}/METADATA").decode()
        bundled = wheel.read(f"{info}/licenses/BUNDLED").decode()
        record = wheel.read(f"{info}/RECORD").decode()
    assert all("copyright" in text.lower() for text in texts)
    # a text that a licence refers to is there, too
    for name in set(re.findall(r"/common-licenses/([\w.+-]*\w)", "".join(texts))):
        assert (
            f"{info}/licenses/common/{name}" in names
            or not Path(f"/usr/share/common-licenses/{name}").is_file()
        )
    assert f"{info}/licenses/common/LGPL-3" in names  # GMP's
    for name in files:
        assert f"\nLicense-File: {name}\n" in metadata.partition("\n\n")[0] + "\n"
        assert f"{info}/licenses/{name},sha256=" in record
    assert all(re.search(rf"^{re.escape(p)} \d", bundled, re.M) for p in packages)


def test_example_scenes(tmp_path: Path) -> None:
    names = examples.names()
    assert {"flag", "sphere", "tiny"} <= set(names)
    assert drape.World(examples.path("tiny")).step().clean
    with pytest.raises(drape.SceneError, match=r"nothing: no such example.*tiny"):
        examples.path("nothing")
    command = [sys.executable, "-m", "drape"]
    told = subprocess.check_output([*command, "examples"], text=True)
    assert told.split() == names
    folder = tmp_path / "app/scenes"
    subprocess.run([*command, "--quiet", "examples", folder], check=True)
    assert len(list(folder.iterdir())) == len(names) + 2  # README.md, patterns
    drape.Scene.load(folder / "panels.json")
    run = ["run", "app/scenes/tiny.json", "--frames", "1", "--out", "run"]
    subprocess.run([*command, *run], cwd=tmp_path, check=True, capture_output=True)
    assert (tmp_path / "run/frames/cloth_0001.ply").exists()
    again = subprocess.run([*command, "examples", folder], capture_output=True)
    assert again.returncode == 2 and again.stderr.count(b"\n") == 1


class Environment:
    """An environment with the packages of this one, but for drape."""

    def __init__(self, folder: Path) -> None:
        self.links = folder / "links"
        self.links.mkdir()
        (self.links / WHEELS[0].name).symlink_to(WHEELS[0])
        self.stranger()
        self.python = folder / "venv/bin/python"
        make = [sys.executable, "-m", "venv", "--without-pip", folder / "venv"]
        subprocess.run(make, check=True)
        [site] = (folder / "venv/lib").glob("*/site-packages")
        others = [each for each in sys.path if each.endswith("-packages")]
        (site / "others.pth").write_text("\n".join(others))

    def stranger(self) -> None:
        """A wheel like PyPI's: another project with a package of this name."""
        info = "drape-0.3.2.dist-info"
        files = {
            "drape/__init__.py": "def mask_value(text): return '*' * len(text)\n",
            "drape/cli.py": "",
            f"{info}/METADATA": "Metadata-Version: 2.1\nName: drape\nVersion: 0.3.2\n",
            f"{info}/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\n"
            "Tag: py3-none-any\n",
        }
        files[f"{info}/RECORD"] = "".join(f"{name},,\n" for name in files)
        path = self.links / "drape-0.3.2-py3-none-any.whl"
        with zipfile.ZipFile(path, "w") as wheel:
            for name, text in files.items():
                wheel.writestr(name, text)

    def pip(self, *words: str) -> None:
        pip = [sys.executable, "-m", "pip", "--python", self.python, *words]
        if words[0] == "install":
            pip += ["-q", "--no-index", "--no-deps", "--find-links", self.links]
            # else this environment's, which the other one sees too, would do
            pip += [] if "-U" in words else ["--force-reinstall"]
        subprocess.run(pip, check=True, capture_output=True)

    def run(self, *words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [self.python, *words], capture_output=True, text=True, cwd="/"
        )


@needs_wheel
def test_pypis_drape_does_not_replace_it(tmp_path: Path) -> None:
    one = Environment(tmp_path)
    sees = ("-c", "import drape; print(drape.World, drape.__version__)")
    one.pip("install", str(WHEELS[0]))
    one.pip("install", "-U", "drape-cloth")  # the stranger's is newer
    assert one.run(*sees).stdout.startswith("<class 'drape.world.World'> 0.")
    # theirs over ours: their package is imported, and ours says what has happened
    one.pip("install", "drape")
    assert one.run("-c", "import drape; drape.mask_value").returncode == 0
    told = one.run("-m", "drape", "info")
    assert told.returncode == 3 and told.stderr.count("\n") == 1
    assert re.search("drape-cloth, .* `drape` 0.3.2, .*pip uninstall -y", told.stderr)
    assert "ImportError" in one.run("-c", "import drape.world").stderr
    # ours over theirs: one error at import
    one.pip("install", "drape-cloth")
    told = one.run("-c", "import drape")
    assert re.search("ImportError: .*two distributions .*masks secrets", told.stderr)
    # the way out that the error tells
    one.pip("uninstall", "-y", "drape", "drape-cloth")
    one.pip("install", "drape-cloth")
    assert one.run(*sees).returncode == 0
    assert one.run("-m", "drape", "info").stdout.startswith("drape ")
