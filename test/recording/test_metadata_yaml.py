"""The YAML of metadata is that of ruamel.yaml to the last byte, also where topics are known from the bag before."""

from copy import deepcopy
from io import StringIO
from typing import Any

import pytest
from rosbags.rosbag2.writer import YAML

from kapitsa_ros.recording.metadata_yaml import MetadataYaml
from kapitsa_ros.resources import resource_path

ROOT = 'rosbag2_bagfile_information'


def written(document: Any, kind: type = MetadataYaml) -> str:
    yaml, stream = kind(typ='safe'), StringIO()
    yaml.default_flow_style = False
    yaml.dump(document, stream)
    return stream.getvalue()


@pytest.fixture
def metadata() -> dict[str, Any]:
    text = resource_path('bags', 'run_01_2240rpm', 'metadata.yaml').read_text(encoding='utf-8')
    read: dict[str, Any] = YAML(typ='safe').load(text)
    return read


def test_metadata_have_the_bytes_of_ruamel(metadata: dict[str, Any]) -> None:
    for number in range(3):
        later = deepcopy(metadata)
        later[ROOT]['custom_data'] = {'digest': '12e4', 'motion_chunks': 64 * str(number), 'complete': 'true'}
        for topic in later[ROOT]['topics_with_message_count']:
            topic['message_count'] += number
        later[ROOT]['topics_with_message_count'][number]['topic_metadata']['name'] = f'/of {number}: {90 * "x"}'
        for document in (later, later[ROOT]):
            assert written(document) == written(document, YAML)


def test_without_topics_and_of_qos_profiles_too(metadata: dict[str, Any]) -> None:
    profiles = metadata[ROOT]['topics_with_message_count'][0]['topic_metadata']['offered_qos_profiles']
    for document in ([], profiles, metadata | {ROOT: metadata[ROOT] | {'topics_with_message_count': []}}):
        assert written(document) == written(document, YAML)
