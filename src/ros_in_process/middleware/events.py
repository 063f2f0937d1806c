"""Quality-of-service events of publishers and subscriptions, counted since they were last taken."""

from __future__ import annotations

from typing import Any

from ros_in_process.middleware import records
from ros_in_process.middleware.graph import Waitable
from ros_in_process.middleware.records import MODULE


class Status:
    """Counts of an event since it was last taken; counted even if nothing handles it."""

    def __init__(self, record: Any) -> None:
        self.values = record()
        if hasattr(self.values, "last_policy_kind"):
            self.values.last_policy_kind = records.rmw_qos_policy_kind_t.RMW_QOS_POLICY_INVALID
        self.has_changed = False
        self._handles: list[EventHandle] = []

    def subscribe(self, handle: EventHandle) -> None:
        """Notify a handle from now on if something has happened."""
        self._handles.append(handle)
        handle.is_ready = self.has_changed

    def unsubscribe(self, handle: EventHandle) -> None:
        self._handles.remove(handle)

    def count(self, **changes: Any) -> None:
        """Add to the counts; each `name` has a `name_change` that counts with it."""
        for name, change in changes.items():
            if name == "last_policy_kind":
                self.values.last_policy_kind = change
                continue
            setattr(self.values, name, getattr(self.values, name) + change)
            setattr(self.values, f"{name}_change", getattr(self.values, f"{name}_change") + change)
        self._set(True)
        for handle in self._handles:
            handle.changed()

    def take(self) -> Any:
        taken = type(self.values)(*(getattr(self.values, field) for field in self.values.fields))
        for field in self.values.fields:
            if field.endswith("_change"):
                setattr(self.values, field, 0)
        self._set(False)
        return taken

    def _set(self, has_changed: bool) -> None:
        self.has_changed = has_changed
        for handle in self._handles:
            handle.is_ready = has_changed


class EventHandle(Waitable):
    """A handle of one kind of event of a publisher or subscription."""

    def __init__(self, end: Any, event: Any) -> None:
        super().__init__()
        if event not in end.statuses:
            raise TypeError(f"__init__(): incompatible constructor arguments: no {event!r} of a {end.role}")
        self.is_ready = False
        self._status: Status = end.statuses[event]
        self._status.subscribe(self)

    def _release(self) -> None:
        self._status.unsubscribe(self)

    def take_event(self) -> Any:
        return self._status.take()


EventHandle.__module__ = MODULE
