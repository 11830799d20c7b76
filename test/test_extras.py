"""What needs an extra that is not installed is said in one line; a defect of ours is not taken for it."""

import sys

import pytest

import kapitsa_ros
from kapitsa_ros.errors import MissingPackageError
from kapitsa_ros.extras import import_of_extra


def test_a_missing_package_is_named_with_the_extra_that_brings_it():
    with pytest.raises(
        MissingPackageError,
        match=r'^a plot needs no_such_package: run `make setup`, or pip install "kapitsa_ros\[report\]"$',
    ):
        import_of_extra('no_such_package', 'a plot', 'report')


def test_a_package_that_one_of_our_modules_needs_is_named(monkeypatch: pytest.MonkeyPatch):
    for name in [name for name in sys.modules if name.startswith(('kapitsa_ros.reporting.figures', 'matplotlib'))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, 'meta_path', [_Without('matplotlib'), *sys.meta_path])
    with pytest.raises(MissingPackageError, match=r'^a plot needs matplotlib'):
        kapitsa_ros.theory(speed='2240 RPM').plot()


def test_a_missing_module_of_ours_is_a_defect():
    with pytest.raises(ModuleNotFoundError, match='no_such_module'):
        import_of_extra('kapitsa_ros.no_such_module', 'a plot', 'report')


class _Without:
    """A finder that finds nothing of a package."""

    def __init__(self, package: str) -> None:
        self.package = package

    def find_spec(self, name: str, *_: object) -> None:
        if name.partition('.')[0] == self.package:
            raise ModuleNotFoundError(f'No module named {name!r}', name=name)
