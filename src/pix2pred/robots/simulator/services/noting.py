"""What programs write into the robot's log: it is taken, and kept nowhere."""

from __future__ import annotations

from typing import Any

from bosdyn.api import data_buffer_pb2, data_buffer_service_pb2_grpc

from pix2pred.robots.simulator.services.answering import answering
from pix2pred.robots.simulator.spot import SimulatedSpot


class DataBufferService(data_buffer_service_pb2_grpc.DataBufferServiceServicer):
    """``data-buffer``: comments, messages, events and other data."""

    def __init__(self, spot: SimulatedSpot) -> None:
        self._spot = spot

    def RecordOperatorComments(self, request: Any, context: Any) -> Any:  # noqa: N802
        """What an operator says."""
        return self._taken(request, data_buffer_pb2.RecordOperatorCommentsResponse())

    def RecordTextMessages(self, request: Any, context: Any) -> Any:  # noqa: N802
        """Messages of programs."""
        return self._taken(request, data_buffer_pb2.RecordTextMessagesResponse())

    def RecordEvents(self, request: Any, context: Any) -> Any:  # noqa: N802
        """Events."""
        return self._taken(request, data_buffer_pb2.RecordEventsResponse())

    def RecordDataBlobs(self, request: Any, context: Any) -> Any:  # noqa: N802
        """Data of any kind."""
        return self._taken(request, data_buffer_pb2.RecordDataBlobsResponse())

    def _taken(self, request: Any, answer: Any) -> Any:
        with answering(self._spot, request, answer):
            pass
        return answer
