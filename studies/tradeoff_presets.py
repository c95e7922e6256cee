"""The presets of a config among the study's records: what each costs and how wrong it is."""

from campaign.presets import PRESETS

__all__ = ["PRESETS", "cost_of", "record_of"]


def record_of(name: str, case: dict) -> dict | None:
    """The record of the study that has the preset's mesh, step and design; None where none has.

    On a line Smolyak's points are the Lobatto points of the same order.
    """
    preset = PRESETS[name]
    methods = ("smolyak", "tensor_lobatto") if case["dimension"] == 1 else ("smolyak",)
    for record in case["records"]:
        same = all(record[key] == preset[key] for key in ("elements", "safety", "order"))
        plain = (record["align"], record["model"]) == ("none", "polynomial")
        if same and plain and record["method"] in methods:
            return record
    return None


def cost_of(name: str, record: dict) -> tuple[int, float]:
    """Runs with the held-out ones, and their cpu time (s) in whole batches, bounds included."""
    runs = record["runs"] + PRESETS[name]["held_out"]
    batches = -(-runs // record["lanes"])
    return runs, batches * record["cpu_batch"] + record["cpu_bounds"]
