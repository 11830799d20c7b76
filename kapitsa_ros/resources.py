"""Where the package's data files are: in a checkout, or below the prefix it was installed into."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def resource_path(*parts: str) -> Path:
    """Return a path below share/kapitsa_ros (`config/...`, `launch/...`).

    Raises
    ------
    FileNotFoundError
        The package was installed without its data files.

    """
    checkout = _PACKAGE.parent
    if (checkout / 'package.xml').is_file():
        return checkout.joinpath(*parts)
    for prefix in _PACKAGE.parents:
        share = prefix / 'share' / 'kapitsa_ros'
        if share.is_dir():
            return share.joinpath(*parts)
    raise FileNotFoundError(f'no share/kapitsa_ros above {_PACKAGE}: install the package again with pip or colcon')
