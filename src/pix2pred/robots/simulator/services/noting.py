"""What programs write into the robot's log: it is taken, and kept nowhere."""

from __future__ import annotations

from typing import Any

from bosdyn.api import data_buffer_pb2, data_buffer_service_pb2_grpc

from pix2pred.robots.simulator.services.answering import Service, answers


class DataBufferService(Service, data_buffer_service_pb2_grpc.DataBufferServiceServicer):
    """``data-buffer``: comments, messages, events and other data."""

    @answers(data_buffer_pb2.RecordOperatorCommentsResponse)
    def RecordOperatorComments(self, request: Any, answer: Any) -> None:  # noqa: N802
        """What an operator says."""

    @answers(data_buffer_pb2.RecordTextMessagesResponse)
    def RecordTextMessages(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Messages of programs."""

    @answers(data_buffer_pb2.RecordEventsResponse)
    def RecordEvents(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Events."""

    @answers(data_buffer_pb2.RecordDataBlobsResponse)
    def RecordDataBlobs(self, request: Any, answer: Any) -> None:  # noqa: N802
        """Data of any kind."""
