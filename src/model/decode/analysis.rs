//! Reads the settings of the analysis.

use crate::model::decode::reader::{Choices, Fields, Input, boolean, count, number, text};
use crate::model::input::mistakes::Mistakes;
use crate::model::request::{
    Analysis, ArcLength, Certificate, ContactRange, ElementReference, Events, Explore, ForceRange, JumpMotion,
    JumpMotionKind, LoadSign, Method, Mpec, OnPathEnd, Record, RecordedContact, RecordedContacts, RecordedElements,
    RecordedSupports, Regularised, Selection,
};

const ANALYSIS: Fields = Fields {
    what: "an analysis",
    known: &[
        "method",
        "selection",
        "events",
        "arc_length",
        "max_increments",
        "max_modes",
        "explore",
        "record",
        "on_path_end",
        "jump_motion",
        "keep_all",
        "mpec",
        "regularised",
    ],
    later: &[],
};

const ARC_LENGTH: Fields = Fields {
    what: "an arc length",
    known: &["initial", "min", "max", "displacement_scale", "load_scale", "jump"],
    later: &[],
};

const EXPLORE: Fields = Fields { what: "an exploration", known: &["depth", "max_jobs"], later: &[] };

const RECORD: Fields = Fields {
    what: "a record",
    known: &["nodes", "contacts", "elements", "supports", "every", "directions", "stability"],
    later: &[],
};

const CONTACT_RANGE: Choices<ContactRange> = Choices {
    what: "a range of contacts",
    known: &[("all", ContactRange::All), ("in_reach", ContactRange::InReach)],
    later: &[],
};
const FORCE_RANGE: Choices<ForceRange> = Choices {
    what: "a range of elements or supports",
    known: &[("all", ForceRange::All), ("none", ForceRange::None)],
    later: &[],
};

const RECORDED_CONTACT: Fields = Fields { what: "a recorded contact", known: &["node", "obstacle"], later: &[] };

const MPEC: Fields = Fields { what: "parameters of the program", known: &["certificate"], later: &[] };

const CERTIFICATE: Choices<Certificate> = Choices {
    what: "a use of the certificate",
    known: &[("use", Certificate::Use), ("skip", Certificate::Skip)],
    later: &[],
};

const REGULARISED: Fields = Fields {
    what: "a regularisation",
    known: &["normal_penalty", "tangential_penalty", "desired_iterations", "tolerance", "load_weight", "load_sign"],
    later: &[],
};

pub(super) const METHOD: Choices<Method> = Choices {
    what: "a method",
    known: &[("auto", Method::Auto), ("mpec", Method::Mpec), ("regularised", Method::Regularised)],
    later: &[],
};

const LOAD_SIGN: Choices<LoadSign> = Choices {
    what: "a choice of the load's sign",
    known: &[("determinant", LoadSign::Determinant), ("previous_increment", LoadSign::PreviousIncrement)],
    later: &[],
};

const SELECTION: Choices<Selection> = Choices {
    what: "a selection",
    known: &[
        ("max_dissipation", Selection::MaxDissipation),
        ("min_potential_energy", Selection::MinPotentialEnergy),
        ("straightest", Selection::Straightest),
    ],
    later: &[],
};

const EVENTS: Choices<Events> =
    Choices { what: "a treatment of events", known: &[("auto", Events::Auto), ("all", Events::All)], later: &[] };

const ON_PATH_END: Choices<OnPathEnd> = Choices {
    what: "what happens where the path ends",
    known: &[("stop", OnPathEnd::Stop), ("jump", OnPathEnd::Jump)],
    later: &[],
};

const JUMP_MOTION: Fields = Fields {
    what: "a motion of jumps",
    known: &["kind", "damping_ratio", "tolerance", "max_steps", "keep_steps", "compare"],
    later: &[],
};

const JUMP_MOTION_KIND: Choices<JumpMotionKind> = Choices {
    what: "a kind of motion",
    known: &[("overdamped", JumpMotionKind::Overdamped), ("inertial", JumpMotionKind::Inertial)],
    later: &[],
};

pub(super) fn analysis(input: &Input, mistakes: &mut Mistakes) -> Option<Analysis> {
    let object = input.object(&ANALYSIS, mistakes)?;
    let default = Analysis::default();
    let method =
        object.with_default("method", default.method, mistakes, |input, mistakes| input.choice(&METHOD, mistakes));
    let selection = object
        .with_default("selection", default.selection, mistakes, |input, mistakes| input.choice(&SELECTION, mistakes));
    let events =
        object.with_default("events", default.events, mistakes, |input, mistakes| input.choice(&EVENTS, mistakes));
    let arc_length = object.with_default("arc_length", default.arc_length, mistakes, arc_length);
    let max_increments = object.with_default("max_increments", default.max_increments, mistakes, count);
    let max_modes = object.with_default("max_modes", default.max_modes, mistakes, count);
    let explore = object.optional("explore", mistakes, explore);
    let record = object.optional("record", mistakes, record);
    let on_path_end = object.with_default("on_path_end", default.on_path_end, mistakes, |input, mistakes| {
        input.choice(&ON_PATH_END, mistakes)
    });
    let jump_motion = object.optional("jump_motion", mistakes, jump_motion);
    let keep_all = object.with_default("keep_all", default.keep_all, mistakes, boolean);
    let mpec = object.optional("mpec", mistakes, mpec);
    let regularised = object.optional("regularised", mistakes, regularised);
    Some(Analysis {
        method: method?,
        selection: selection?,
        events: events?,
        arc_length: arc_length?,
        max_increments: max_increments?,
        max_modes: max_modes?,
        explore: explore?,
        record: record?,
        on_path_end: on_path_end?,
        jump_motion: jump_motion?,
        keep_all: keep_all?,
        mpec: mpec?,
        regularised: regularised?,
    })
}

fn arc_length(input: &Input, mistakes: &mut Mistakes) -> Option<ArcLength> {
    let object = input.object(&ARC_LENGTH, mistakes)?;
    let initial = object.optional("initial", mistakes, number);
    let min = object.optional("min", mistakes, number);
    let max = object.optional("max", mistakes, number);
    let displacement_scale = object.optional("displacement_scale", mistakes, number);
    let load_scale = object.optional("load_scale", mistakes, number);
    let jump = object.optional("jump", mistakes, boolean);
    let bounds = ArcLength::with_defaults(initial?, min?, max?);
    let jump = jump?.unwrap_or(bounds.jump);
    Some(ArcLength { displacement_scale: displacement_scale?, load_scale: load_scale?, jump, ..bounds })
}

fn jump_motion(input: &Input, mistakes: &mut Mistakes) -> Option<JumpMotion> {
    let object = input.object(&JUMP_MOTION, mistakes)?;
    let default = JumpMotion::default();
    let kind = object
        .with_default("kind", default.kind, mistakes, |input, mistakes| input.choice(&JUMP_MOTION_KIND, mistakes));
    let damping_ratio = object.optional("damping_ratio", mistakes, number);
    let tolerance = object.with_default("tolerance", default.tolerance, mistakes, number);
    let max_steps = object.with_default("max_steps", default.max_steps, mistakes, count);
    let keep_steps = object.with_default("keep_steps", default.keep_steps, mistakes, boolean);
    let compare = object.with_default("compare", default.compare, mistakes, boolean);
    Some(JumpMotion {
        kind: kind?,
        damping_ratio: damping_ratio?,
        tolerance: tolerance?,
        max_steps: max_steps?,
        keep_steps: keep_steps?,
        compare: compare?,
    })
}

fn explore(input: &Input, mistakes: &mut Mistakes) -> Option<Explore> {
    let object = input.object(&EXPLORE, mistakes)?;
    let depth = object.required("depth", mistakes, count);
    let max_jobs = object.required("max_jobs", mistakes, count);
    Some(Explore { depth: depth?, max_jobs: max_jobs? })
}

fn record(input: &Input, mistakes: &mut Mistakes) -> Option<Record> {
    let object = input.object(&RECORD, mistakes)?;
    let default = Record::default();
    let nodes = object.optional("nodes", mistakes, |input, mistakes| input.list(mistakes, text));
    let contacts = object.optional("contacts", mistakes, recorded_contacts);
    let elements = object.optional("elements", mistakes, recorded_elements);
    let supports = object.optional("supports", mistakes, recorded_supports);
    let every = object.with_default("every", default.every, mistakes, count);
    let directions = object.with_default("directions", default.directions, mistakes, boolean);
    let stability = object.with_default("stability", default.stability, mistakes, boolean);
    Some(Record {
        nodes: nodes?,
        contacts: contacts?,
        elements: elements?,
        supports: supports?,
        every: every?,
        directions: directions?,
        stability: stability?,
    })
}

fn recorded_contacts(input: &Input, mistakes: &mut Mistakes) -> Option<RecordedContacts> {
    if input.is_text() {
        return input.choice(&CONTACT_RANGE, mistakes).map(RecordedContacts::Range);
    }
    if !input.is_list() {
        return input.refuse("\"all\", \"in_reach\" or a list of contacts", mistakes);
    }
    input.list(mistakes, recorded_contact).map(RecordedContacts::Named)
}

fn recorded_elements(input: &Input, mistakes: &mut Mistakes) -> Option<RecordedElements> {
    if input.is_text() {
        return input.choice(&FORCE_RANGE, mistakes).map(RecordedElements::Range);
    }
    if !input.is_list() {
        return input.refuse("\"all\", \"none\" or a list of places and names of elements", mistakes);
    }
    let element = |input: &Input, mistakes: &mut Mistakes| {
        if input.is_text() {
            return text(input, mistakes).map(ElementReference::Name);
        }
        count(input, mistakes).map(ElementReference::Place)
    };
    input.list(mistakes, element).map(RecordedElements::Listed)
}

fn recorded_supports(input: &Input, mistakes: &mut Mistakes) -> Option<RecordedSupports> {
    if input.is_text() {
        return input.choice(&FORCE_RANGE, mistakes).map(RecordedSupports::Range);
    }
    if !input.is_list() {
        return input.refuse("\"all\", \"none\" or a list of supported nodes", mistakes);
    }
    input.list(mistakes, text).map(RecordedSupports::Named)
}

fn recorded_contact(input: &Input, mistakes: &mut Mistakes) -> Option<RecordedContact> {
    let object = input.object(&RECORDED_CONTACT, mistakes)?;
    let node = object.required("node", mistakes, text);
    let obstacle = object.required("obstacle", mistakes, text);
    Some(RecordedContact { node: node?, obstacle: obstacle? })
}

fn mpec(input: &Input, mistakes: &mut Mistakes) -> Option<Mpec> {
    let object = input.object(&MPEC, mistakes)?;
    let default = Mpec::default();
    let certificate = object.with_default("certificate", default.certificate, mistakes, |input, mistakes| {
        input.choice(&CERTIFICATE, mistakes)
    });
    Some(Mpec { certificate: certificate? })
}

fn regularised(input: &Input, mistakes: &mut Mistakes) -> Option<Regularised> {
    let object = input.object(&REGULARISED, mistakes)?;
    let default = Regularised::default();
    let normal_penalty = object.with_default("normal_penalty", default.normal_penalty, mistakes, number);
    let tangential_penalty = object.with_default("tangential_penalty", default.tangential_penalty, mistakes, number);
    let desired_iterations = object.with_default("desired_iterations", default.desired_iterations, mistakes, count);
    let tolerance = object.with_default("tolerance", default.tolerance, mistakes, number);
    let load_weight = object.with_default("load_weight", default.load_weight, mistakes, number);
    let load_sign = object
        .with_default("load_sign", default.load_sign, mistakes, |input, mistakes| input.choice(&LOAD_SIGN, mistakes));
    Some(Regularised {
        normal_penalty: normal_penalty?,
        tangential_penalty: tangential_penalty?,
        desired_iterations: desired_iterations?,
        tolerance: tolerance?,
        load_weight: load_weight?,
        load_sign: load_sign?,
    })
}
