"""The YAML of a bag's metadata, as rosbags has ruamel.yaml write it; what is the same in the next bag is written once.

All but thirty of its three hundred lines describe topics. ruamel.yaml takes a tenth of a second for them, for which the
next run would have to wait.
"""

from __future__ import annotations

from functools import lru_cache
from io import StringIO
from typing import TYPE_CHECKING, Any

from rosbags.rosbag2.writer import YAML  # type: ignore[attr-defined]

if TYPE_CHECKING:
    from typing import TextIO

_ROOT, _TOPICS, _TOPIC = 'rosbag2_bagfile_information', 'topics_with_message_count', 'topic_metadata'
_SIGN = 'metadata-of-topic-{}'


class MetadataYaml:
    """As much of `ruamel.yaml.YAML` as the writer of rosbags uses, and the same text.

    Parameters
    ----------
    typ
        As there.

    """

    def __init__(self, typ: str) -> None:
        assert typ == 'safe'  # noqa: S101  # what rosbags asks for
        self.default_flow_style = False

    def dump(self, document: Any, stream: TextIO) -> None:
        """Write a document: metadata, with the root that rosbag2 gives it or without, or QoS profiles."""
        information = document.get(_ROOT, document) if isinstance(document, dict) else {}
        if _TOPICS not in information:
            stream.write(_remembered(_Key(document)))
            return
        topics = information[_TOPICS]
        signed = [each | {_TOPIC: _SIGN.format(number)} for number, each in enumerate(topics)]
        short = information | {_TOPICS: signed}
        text = _written({_ROOT: short} if _ROOT in document else short)
        for number, each in enumerate(topics):
            alone = {_TOPICS: [{_TOPIC: each[_TOPIC]}]}
            block = _remembered(_Key({_ROOT: alone} if _ROOT in document else alone))
            sign = f'{_TOPIC}: {_SIGN.format(number)}\n'
            before, _, after = text.partition(sign)
            text = before + block[block.index(f'{_TOPIC}:\n') :] + after
        stream.write(text)


class _Key:
    """A document as the key of a cache: equal where its text is."""

    def __init__(self, document: Any) -> None:
        self.document, self._text = document, repr(document)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and self._text == other._text

    def __hash__(self) -> int:
        return hash(self._text)


@lru_cache(maxsize=64)
def _remembered(key: _Key) -> str:
    return _written(key.document)


def _written(document: Any) -> str:
    yaml = YAML(typ='safe')
    yaml.default_flow_style = False
    stream = StringIO()
    yaml.dump(document, stream)
    return stream.getvalue()
