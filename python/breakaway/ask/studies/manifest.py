"""What the manifest of a study has beside what every manifest has."""

from __future__ import annotations

from typing import Any, Literal

from breakaway.ask.durable.manifest import Checked, manifest_with
from breakaway.ask.studies.plan import Plan
from breakaway.ask.studies.run_pieces import label_types, piece_schema
from breakaway.ask.studies.study import Study
from breakaway.run.resolution import resolve


class _Column(Checked):
    name: str
    type: str
    unit: str


class StudyManifest(Checked):
    """What that of a study has beside."""

    seed: int
    labels: dict[str, Literal["bool", "int64", "double", "string"]]
    varied: list[str]
    metrics: list[str]
    columns: list[_Column]


def manifest_of(study: Study, plan: Plan) -> dict[str, Any]:
    """Give what determines the results of a study, and what they look like.

    Examples
    --------
    >>> import breakaway as bk
    >>> from breakaway.ask.studies.study import SweepStudy
    >>> from breakaway.ask.studies.sweep import SweepPlan
    >>> study = SweepStudy(
    ...     scenario="paper_as_computed", changes={"disturbance.var": 0.1}, runs=10
    ... )
    >>> manifest_of(study, SweepPlan(study))["seed"]
    0

    """
    labels = label_types(plan.points)
    schema = piece_schema(labels, plan.varied, study.recorded)
    return manifest_with(
        study.model_dump(mode="json"),
        ["numpy", "scipy", *(["SALib"] if study.kind == "sensitivity" else [])],
        scenario=resolve(study.base).model_dump(mode="json"),
        seed=study.base.seed,
        runs_max=plan.runs_max,
        runs_per_piece=study.runs_per_piece,
        labels=labels,
        varied=plan.varied,
        metrics=list(study.recorded),
        columns=[
            {"name": f.name, "type": str(f.type), "unit": f.metadata[b"unit"].decode()}
            for f in schema
        ],
    )
