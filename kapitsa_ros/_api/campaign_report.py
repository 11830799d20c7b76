"""`campaign_report`: one file about a campaign's outcomes."""

from __future__ import annotations

from pathlib import Path

from kapitsa_ros._api.report import report_format
from kapitsa_ros.laboratory.campaign_file import UNIT, read_campaign, version_of
from kapitsa_ros.output_file import check_output, replacing


def campaign_report(
    campaign: str | Path,
    output: str | Path,
    *,
    format: str | None = None,  # noqa: A002 - the option's name
    overwrite: bool = False,
) -> Path:
    """Write how often intervals hold and how far estimates deviate, by each factor of a campaign.

    Parameters
    ----------
    campaign
        The Parquet file that `campaign(output=...)` has written.
    output
        The file to write; its folder must be there.
    format
        html, md or pdf; by the suffix of `output` where not given, and html where that is none of them.
    overwrite
        A file that is there may be replaced.

    Returns
    -------
    Path
        That of the file.

    Raises
    ------
    KapitsaError
        It is no campaign, the file is there already, or the `report` extra is not installed.

    """
    page = Path(output)
    check_output(page, overwrite=overwrite)
    write = report_format(page, format)
    from kapitsa_ros.reporting.report import campaign_document  # noqa: PLC0415  # an extra, which is there

    table = read_campaign(Path(campaign))
    columns = {name: table[name].to_numpy(zero_copy_only=False) for name in table.column_names}
    units = {field.name: (field.metadata or {}).get(UNIT, b'').decode() for field in table.schema}
    with replacing(page) as draft:
        write(campaign_document(columns, units, version_of(table)), draft)
    return page
