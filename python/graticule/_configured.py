"""Solving as `graticule solve` does, and comparing as `graticule compare` does."""

from __future__ import annotations

import copy
import math
import statistics
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Union

from . import _graticule as g

Problem = Union[g.Graph, g.Recording]
Configuration = Union[Mapping[str, Any], str, Path]


@dataclass
class ConfiguredSolution:
    """What came of a problem and a configuration."""

    solution: g.Solution
    graph: g.Graph
    """A copy of the problem's: its own values are where the solve began."""
    start: str
    """One line: where the initial values came from."""
    initialise: g.PhaseTime
    rejection: Optional[g.RejectionReport] = None
    """None: nothing was looked for."""
    second_look: Optional[g.SecondLook] = None
    """None: none was taken (docs/starts.md)."""

    @property
    def values(self) -> g.Values:
        """Of the graph's variables."""
        return self.solution.values

    @property
    def report(self) -> g.Report:
        """What the solve did."""
        return self.solution.report

    def recording(self) -> g.Recording:
        """The solved problem, as `write_problem` writes it."""
        solved = g.Recording(self.graph)
        solved.graph.set_values(self.values)
        solved.solved_by = f"graticule {g.__version__}"
        solved.report = g.report_json(self.report).strip()
        return solved


def _options(configuration: Optional[Configuration], more: Mapping[str, Any]) -> Dict[str, Any]:
    if isinstance(configuration, (str, Path)):
        configuration = g.read_config(str(configuration))
    return {**(configuration or {}), **more}


def solve_configured(
    problem: Problem,
    configuration: Optional[Configuration] = None,
    *,
    on_iteration: Optional[Callable[[g.Iteration], Any]] = None,
    **options: Any,
) -> ConfiguredSolution:
    """Solves a problem as `graticule solve` does, to the same digits.

    `configuration` is a mapping, or the path of a YAML file, of the options in docs/options.md: where
    to start from (`initialise`), what to reject (`reject_outliers`), and the solver's own; keywords
    come on top.  The problem is not changed.
    """
    chosen = _options(configuration, options)

    def of(names: Sequence[str]) -> Dict[str, Any]:
        return {name: chosen.pop(name) for name in names if name in chosen}

    start = g.InitialiseOptions(**of(g.InitialiseOptions._fields))
    rejection = g.RejectionOptions(**of(g.RejectionOptions._fields))
    solve = g.SolveOptions(**chosen)
    recording = problem if isinstance(problem, g.Recording) else None
    graph = copy.copy(recording.graph if recording else problem)
    assert isinstance(graph, g.Graph)
    has_guess = recording.has_initial_guess if recording else True
    if rejection.reject_outliers == "none":
        solved = g.initialise_and_solve(
            graph, start.initialise, has_guess, solve, on_iteration=on_iteration
        )
        return ConfiguredSolution(
            solved.solution, graph, solved.start.summary, solved.initialise,
            second_look=solved.second_look,
        )
    from_values = start.initialise != "automatic"
    began, cpu = time.perf_counter(), time.process_time()
    summary = "trusted factors"
    if from_values:
        summary = g.initialise(graph, start.initialise, has_guess).summary
    took = g.PhaseTime(wall=time.perf_counter() - began, cpu=time.process_time() - cpu)
    robust = g.solve_without_outliers(
        graph, rejection, solve, from_values, on_iteration=on_iteration
    )
    graph.set_values(robust.start)
    return ConfiguredSolution(robust.solution, graph, summary, took, rejection=robust.rejection)


def _median(timings: List[g.Timing]) -> g.Timing:
    def phase(name: str) -> g.PhaseTime:
        phases = [getattr(timing, name) for timing in timings]
        return g.PhaseTime(
            wall=statistics.median(p.wall for p in phases),
            cpu=statistics.median(p.cpu for p in phases),
        )

    return g.Timing(**{name: phase(name) for name in g.Timing._fields})


def _run(name: str, problem: Problem, configuration: str, options: Mapping[str, Any],
         repeats: int) -> g.ComparisonRun:
    run = g.ComparisonRun(file=name, configuration=configuration, repeats=repeats)
    timings = []
    try:
        for _ in range(repeats):
            began, cpu = time.perf_counter(), time.process_time()
            solved = solve_configured(problem, options)
            timing = copy.copy(solved.report.timing)
            timing.initialise = solved.initialise
            timing.total = g.PhaseTime(
                wall=time.perf_counter() - began, cpu=time.process_time() - cpu
            )
            timings.append(timing)
            if len(timings) == 1:
                run.report = solved.report
    except g.Error as error:
        if error.kind == g.ErrorKind.USAGE:
            raise
        run.error = str(error)
    if timings:
        run.median = _median(timings)
        totals = [timing.total.wall for timing in timings]
        run.min_total_s, run.max_total_s = min(totals), max(totals)
    return run


def compare(
    problems: Union[Mapping[str, Problem], Sequence[Union[str, Path]]],
    configurations: Union[Mapping[str, Mapping[str, Any]], Sequence[Union[str, Path]]],
    *,
    repeats: int = 1,
    best_known: Optional[Mapping[str, float]] = None,
) -> g.Comparison:
    """Solves every problem with every configuration.

    problems: by name, or paths.  configurations: options by name, or paths of YAML files.
    best_known: costs by problem; without, gaps are to the lowest cost of this comparison.  Times are
    medians over `repeats`, without loading.  Options that do not exist raise UsageError; a problem
    that cannot be solved is a run with an `error`.
    """
    if not isinstance(problems, Mapping):
        problems = {str(path): g.read_problem(str(path)) for path in problems}
    if not isinstance(configurations, Mapping):
        configurations = {Path(path).stem: g.read_config(str(path)) for path in configurations}
    runs = []
    for name, problem in problems.items():
        of_problem = [
            _run(name, problem, configuration, options, repeats)
            for configuration, options in configurations.items()
        ]
        # A run that rejected factors answers another question: it has no gap.
        most = max((run.report.factors for run in of_problem), default=0)
        costs = [
            run.report.final_cost
            for run in of_problem
            if not run.error and run.report.factors == most and math.isfinite(run.report.final_cost)
        ]
        for run in of_problem:
            if run.error or not costs or run.report.factors != most:
                continue
            run.best_known = (best_known or {}).get(name, min(costs))
            least = max(abs(run.best_known), 1e-12 * run.report.initial_cost, 1e-300)
            run.gap = (run.report.final_cost - run.best_known) / least
        runs += of_problem
    return g.make_comparison(runs)
