"""Decompression of what others have compressed: no more comes out than was announced."""

from __future__ import annotations

import zlib

import lz4.frame
import zstandard

ZSTD_MAGIC = b'\x28\xb5\x2f\xfd'
LARGEST = 2**29
"""Bytes of a chunk or a message at most."""


class DecompressionError(ValueError):
    """The bytes are not what they say they are."""


def unpack_chunk(
    data: bytes, compression: str, size: int, crc: int, unpacker: zstandard.ZstdDecompressor | None = None
) -> bytes:
    """Return what is in a chunk.

    Parameters
    ----------
    data
        Its bytes.
    compression
        `zstd`, `lz4` or empty.
    size
        Bytes when unpacked, as the chunk says.
    crc
        CRC-32 of the unpacked bytes; 0: none was recorded.
    unpacker
        Spares making one, for whoever unpacks many; it serves one thread.

    Raises
    ------
    DecompressionError
        Size or checksum are others, or the bytes cannot be unpacked.

    """
    if size > LARGEST:
        raise DecompressionError(f'it says that it unpacks to {size} bytes, more than {LARGEST}')
    if compression == 'zstd':
        unpacked = _unpack_zstd(data, size, unpacker)
    elif compression == 'lz4':
        try:
            # One byte more than announced, so that more is noticed.
            unpacked = lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=size + 1)
        except (RuntimeError, EOFError) as error:
            raise DecompressionError(f'it cannot be unpacked ({error})') from error
    elif not compression:
        unpacked = data
    else:
        raise DecompressionError(f'its compression {compression!r} is not known: zstd and lz4 are')
    if len(unpacked) != size:
        raise DecompressionError(f'it holds {len(unpacked)} bytes where it says {size}')
    if crc and zlib.crc32(unpacked) != crc:
        raise DecompressionError('its checksum does not match')
    return unpacked


def unpack_message(data: bytes) -> bytes:
    """Return the bytes of a message that was compressed by itself; one that was not starts otherwise.

    Raises
    ------
    DecompressionError
        The bytes cannot be unpacked.

    """
    return _unpack_zstd(data, LARGEST) if data.startswith(ZSTD_MAGIC) else data


def _unpack_zstd(data: bytes, most: int, unpacker: zstandard.ZstdDecompressor | None = None) -> bytes:
    unpacker = unpacker or zstandard.ZstdDecompressor()
    try:
        announced = zstandard.frame_content_size(data)  # -1: it does not say
        if announced > most:
            raise DecompressionError(f'it says that it unpacks to {announced} bytes, more than {most}')
        if announced < 0:
            with unpacker.stream_reader(data) as stream:
                unpacked = stream.read(most + 1)
        else:
            unpacked = unpacker.decompress(data, max_output_size=most)
    except (zstandard.ZstdError, MemoryError) as error:
        raise DecompressionError(f'it cannot be unpacked ({error})') from error
    if len(unpacked) > most:
        raise DecompressionError(f'it unpacks to more than {most} bytes')
    return bytes(unpacked)
