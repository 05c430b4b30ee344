"""FTP packets survive encoding and decoding."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from dialects import messages as m
from link.services.ftp.protocol import FtpPacket, parse_packet
from tests.link.ftp_rig import MAX_OFFSET


@given(
    st.builds(
        FtpPacket,
        st.integers(0, 65535),
        st.integers(0, 255),
        st.integers(0, 255),
        st.binary(max_size=239),
        st.integers(0, MAX_OFFSET),
        st.integers(0, 255),
        st.booleans(),
    )
)
def test_a_packet_comes_out_as_it_went_in(packet: FtpPacket) -> None:
    again = parse_packet(m.FileTransferProtocol(0, 1, 1, packet.payload()))
    assert again == replace(packet, size=len(packet.data))
