//! How a stage begins, ends and hands over to the next.

use super::advance::AT_END;
use super::decide::{self, Before};
use super::history::History;
use super::increment::{Increment, Point, PointKind};
use super::mode_system::ModeSystem;
use super::name_event::describe_start;
use super::progress::{Phase, StageCounts};
use super::scene::End;
use super::state::Rate;
use super::stop::StopReason;
use super::tracer::{Emitted, Path};
use super::watch::Watch;

impl Path<'_> {
    /// The row with which a stage begins: the directions that exist there, one of them taken. Where a bound of the stage
    /// is met already, it ends there too.
    pub(super) fn begin_stage(&mut self) -> Increment {
        if self.at.phase == Phase::Running {
            self.at.totals.index += 1;
        }
        self.at.phase = Phase::Running;
        self.look_ahead(self.at.step);
        self.at.stage_over = self.bound_is_met();
        let event = describe_start(self.scene, self.at.stage, self.at.stage_over);
        let mut point = Point::plain(PointKind::Start, Some(event));
        let (mut options, mut taken) = (Vec::new(), None);
        if !self.at.stage_over {
            let state = &self.at.here.state;
            let mut decision =
                decide::decide(self.loading(), state, &self.standings(state), Before::StageStart, self.rules());
            self.take(&mut decision);
            self.at.begun = self.at.here.rate.clone().map(|rate| (self.at.here.state.clone(), rate));
            self.at.step = self.at.step.min(self.scene.analysis.arc_length.initial);
            point.bifurcation = decide::is_bifurcation(&decision.options, decision.taken, None);
            point.unexplored_modes = decision.unexplored;
            point.degenerate = decision.degenerate;
            if let Some(reason) = decision.stop {
                self.end(reason);
            }
            (options, taken) = (decision.options, decision.taken);
        }
        let here = &self.at.here;
        let (state, modes) = (here.state.clone(), here.modes.clone());
        let system = ModeSystem::new(self.loading(), &modes, &state);
        let residual = system.judged(state.clone(), self.at.totals.force_scale).residual;
        let error_estimate = here.drift.as_ref().map_or(0.0, Rate::size);
        self.emit(Emitted {
            before: &state,
            reactions: None,
            modes: &modes,
            step: 0.0,
            point,
            options,
            taken,
            residual,
            error_estimate,
            mode_named: None,
            arriving: None,
        })
    }

    /// Whether a load or displacement at which the stage ends is met before it begins.
    fn bound_is_met(&self) -> bool {
        let here = &self.at.here;
        let still = Rate {
            displacement: vec![0.0; here.state.displacement.len()],
            load: 0.0,
            reactions: here.state.reactions.clone(),
        };
        let left = |end: &End| Watch::End(*end).value(self.loading(), &here.modes, &here.state, &still);
        self.scene.stages[self.at.stage].ends.iter().any(|end| left(end) <= 0.0)
    }

    /// Holds what the stage reached and goes to the next; `false` where there is none.
    pub(super) fn next_stage(&mut self) -> bool {
        if self.at.stage + 1 == self.scene.stages.len() {
            self.end(StopReason::StagesCompleted);
            return false;
        }
        let at = &mut self.at;
        at.reached.push(at.here.state.load);
        at.hold(self.scene);
        at.stage += 1;
        at.here.state.load = 0.0;
        at.here.rate = None;
        at.here.signature = None;
        (at.here.before, at.here.apart) = (None, None);
        at.counts = StageCounts::default();
        at.visited = History::default();
        self.load_anew();
        true
    }

    /// Whether a load or displacement at which the stage ends is reached here, whatever else happens here; it is then
    /// made exact.
    pub(super) fn at_bound(&mut self, rate: &Rate) -> bool {
        let here = &self.at.here;
        let left = |end: &End| Watch::End(*end).value(self.loading(), &here.modes, &here.state, rate);
        let met = self.scene.stages[self.at.stage].ends.iter().find(|end| left(end) <= AT_END);
        if let Some(End::Load { bound, .. }) = met {
            self.at.here.state.load = *bound;
        }
        met.is_some()
    }
}
