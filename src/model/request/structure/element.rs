//! Bars, springs and beams.

use crate::mechanics::structure::elements::bar::Strain;
use crate::mechanics::structure::elements::solid::shapes::kind::SolidKind;
use crate::model::request::structure::component::Component;
use crate::model::request::structure::mesh::MeshGroup;
use crate::model::request::structure::solid::Solid;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// An elastic element: a bar, a spring, a beam, a solid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Element {
    /// A pin-jointed bar, geometrically exact.
    Bar {
        /// Two different node names.
        #[cfg_attr(feature = "server", schema(min_items = 2, max_items = 2))]
        nodes: Vec<String>,
        /// EA (force), positive.
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        axial_stiffness: f64,
        /// Unstressed length; the distance of the nodes when absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        rest_length: Option<f64>,
        /// Axial force (tension positive) added to the elastic one.
        #[serde(default)]
        prestress: f64,
        /// Measure of the bar's strain, `engineering` when absent.
        #[serde(default)]
        strain: Strain,
        /// By which results and `analysis.record` refer to the element; one element has it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// A constant stiffness between one node and the ground, or between two nodes; it does not follow rotation.
    Spring {
        /// One or two node names.
        #[cfg_attr(feature = "server", schema(min_items = 1, max_items = 2))]
        nodes: Vec<String>,
        /// Symmetric, `dimension` rows of `dimension` numbers (force per length).
        #[cfg_attr(feature = "server", schema(min_items = 2, max_items = 3))]
        stiffness: Vec<Vec<f64>>,
        /// By which results and `analysis.record` refer to the element; one element has it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// A geometrically exact beam, which stretches, bends and shears, in space also twists; free of stress as drawn.
    Beam {
        /// Two node names, or three in order along the beam: the beam then follows the circle through them.
        #[cfg_attr(feature = "server", schema(min_items = 2, max_items = 3))]
        nodes: Vec<String>,
        /// EA (force), positive.
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        axial_stiffness: f64,
        /// EI (force times length squared), positive; in space `[EI_1, EI_2]`, against bending about axes 1 and 2.
        bending_stiffness: BendingStiffness,
        /// In space, GJ (force times length squared), positive.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        torsional_stiffness: Option<f64>,
        /// In space, a vector not parallel to the beam: its part across the beam (of three nodes: across the tangent at the
        /// second) is axis 1 of the cross-section. Axis 2 is a quarter turn about the beam's direction from it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "server", schema(min_items = 3, max_items = 3))]
        orientation: Option<Vec<f64>>,
        /// GA of the area in shear (force), positive, in space along both axes; absent: the beam does not shear.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        shear_stiffness: Option<f64>,
        /// In the plane, name of an end node to what is released there: `rz` makes a hinge between this beam and the node.
        #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
        releases: IndexMap<String, Vec<Component>>,
        /// By which results and `analysis.record` refer to the element; one element has it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// A constant stiffness against the rotation of one node, or between the rotations of two nodes, in the plane.
    RotationalSpring {
        /// One or two node names.
        #[cfg_attr(feature = "server", schema(min_items = 1, max_items = 2))]
        nodes: Vec<String>,
        /// Moment per angle (force times length), positive.
        #[cfg_attr(feature = "server", schema(exclusive_minimum = 0.0))]
        stiffness: f64,
        /// By which results and `analysis.record` refer to the element; one element has it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// A linear triangle.
    Triangle3(Solid),
    /// A quadratic triangle.
    Triangle6(Solid),
    /// A bilinear quadrilateral.
    Quadrilateral4(Solid),
    /// A quadratic quadrilateral.
    Quadrilateral8(Solid),
    /// A linear tetrahedron.
    Tetrahedron4(Solid),
    /// A quadratic tetrahedron.
    Tetrahedron10(Solid),
    /// A trilinear hexahedron.
    Hexahedron8(Solid),
    /// A quadratic hexahedron.
    Hexahedron20(Solid),
    /// The elements of a group of the mesh, each a solid of its kind.
    Solid(MeshGroup),
}

/// The stiffness of a beam against bending (force times length squared).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(untagged)]
pub enum BendingStiffness {
    /// In the plane.
    Plane(f64),
    /// In space, about axes 1 and 2.
    Space([f64; 2]),
}

impl BendingStiffness {
    /// The smallest.
    pub fn least(self) -> f64 {
        match self {
            Self::Plane(stiffness) => stiffness,
            Self::Space([first, second]) => first.min(second),
        }
    }
}

impl Element {
    /// A bar between two nodes, of axial stiffness EA (force, positive), unstressed where its nodes are given.
    ///
    /// ```
    /// use arcslip::{Element, Strain};
    ///
    /// let bar = Element::bar("pin", "tip", 2.0e6).with_prestress(150.0).with_strain(Strain::Green);
    /// let spring = Element::spring_between("tip", "anchor", [[1.0, -0.8], [-0.8, 1.0]]);
    /// assert_eq!(bar.nodes(), ["pin", "tip"]);
    /// assert_eq!(spring.nodes(), ["tip", "anchor"]);
    /// ```
    pub fn bar(from: impl Into<String>, to: impl Into<String>, axial_stiffness: f64) -> Self {
        Self::Bar {
            nodes: vec![from.into(), to.into()],
            axial_stiffness,
            rest_length: None,
            prestress: 0.0,
            strain: Strain::default(),
            name: None,
        }
    }

    /// A spring between a node and the ground; `stiffness` is symmetric, force per length.
    pub fn spring<const DIMENSION: usize>(node: impl Into<String>, stiffness: [[f64; DIMENSION]; DIMENSION]) -> Self {
        Self::Spring { nodes: vec![node.into()], stiffness: rows(stiffness), name: None }
    }

    /// A spring between two nodes; `stiffness` is symmetric, force per length.
    pub fn spring_between<const DIMENSION: usize>(
        from: impl Into<String>,
        to: impl Into<String>,
        stiffness: [[f64; DIMENSION]; DIMENSION],
    ) -> Self {
        Self::Spring { nodes: vec![from.into(), to.into()], stiffness: rows(stiffness), name: None }
    }

    /// A beam in the plane through two or three nodes, of axial stiffness EA (force) and bending stiffness EI (force times
    /// length squared), which does not shear.
    ///
    /// ```
    /// use arcslip::Element;
    ///
    /// let straight = Element::beam(["clamp", "tip"], 1.0e6, 2.0).with_shear_stiffness(4.0e5);
    /// let arc = Element::beam(["left", "crown", "right"], 1.0e6, 2.0).with_hinge("right");
    /// assert_eq!((straight.nodes().len(), arc.nodes().len()), (2, 3));
    /// ```
    pub fn beam<const NODES: usize>(
        nodes: [impl Into<String>; NODES],
        axial_stiffness: f64,
        bending_stiffness: f64,
    ) -> Self {
        Self::Beam {
            nodes: nodes.map(Into::into).into(),
            axial_stiffness,
            bending_stiffness: BendingStiffness::Plane(bending_stiffness),
            torsional_stiffness: None,
            orientation: None,
            shear_stiffness: None,
            releases: IndexMap::new(),
            name: None,
        }
    }

    /// A beam in space through two or three nodes, of axial stiffness EA (force), bending stiffnesses EI about axes 1 and 2
    /// and torsional stiffness GJ (force times length squared), which does not shear. Axis 1 is the part of `orientation`
    /// across the beam.
    ///
    /// ```
    /// use arcslip::Element;
    ///
    /// let strip = Element::beam_in_space(["clamp", "tip"], 1.0e6, [40.0, 0.1], 0.15, [0.0, 1.0, 0.0]);
    /// assert_eq!(strip.nodes(), ["clamp", "tip"]);
    /// ```
    pub fn beam_in_space<const NODES: usize>(
        nodes: [impl Into<String>; NODES],
        axial_stiffness: f64,
        bending_stiffness: [f64; 2],
        torsional_stiffness: f64,
        orientation: [f64; 3],
    ) -> Self {
        Self::Beam {
            nodes: nodes.map(Into::into).into(),
            axial_stiffness,
            bending_stiffness: BendingStiffness::Space(bending_stiffness),
            torsional_stiffness: Some(torsional_stiffness),
            orientation: Some(orientation.into()),
            shear_stiffness: None,
            releases: IndexMap::new(),
            name: None,
        }
    }

    /// A spring between the rotation of a node and the ground; `stiffness` is moment per angle.
    pub fn rotational_spring(node: impl Into<String>, stiffness: f64) -> Self {
        Self::RotationalSpring { nodes: vec![node.into()], stiffness, name: None }
    }

    /// The beam with shear, of stiffness GA (force); another element as it is.
    #[must_use]
    pub fn with_shear_stiffness(mut self, stiffness: f64) -> Self {
        if let Self::Beam { shear_stiffness, .. } = &mut self {
            *shear_stiffness = Some(stiffness);
        }
        self
    }

    /// The beam with a hinge between it and an end node; another element as it is.
    #[must_use]
    pub fn with_hinge(mut self, node: impl Into<String>) -> Self {
        if let Self::Beam { releases, .. } = &mut self {
            releases.insert(node.into(), vec![Component::Rz]);
        }
        self
    }

    /// Whether the element is joined to a node by the node's rotation.
    pub fn turns_with(&self, node: &str) -> bool {
        match self {
            Self::Beam { releases, .. } => {
                !releases.get(node).is_some_and(|released| released.contains(&Component::Rz))
            }
            Self::RotationalSpring { .. } => true,
            _ => false,
        }
    }

    /// The bar with another unstressed length than the distance of its nodes; a spring as it is.
    #[must_use]
    pub fn with_rest_length(mut self, length: f64) -> Self {
        if let Self::Bar { rest_length, .. } = &mut self {
            *rest_length = Some(length);
        }
        self
    }

    /// The bar with an axial force (tension positive) added to the elastic one; a spring as it is.
    #[must_use]
    pub fn with_prestress(mut self, force: f64) -> Self {
        if let Self::Bar { prestress, .. } = &mut self {
            *prestress = force;
        }
        self
    }

    /// The bar with another measure of its strain than the engineering strain; a spring as it is.
    #[must_use]
    pub fn with_strain(mut self, measure: Strain) -> Self {
        if let Self::Bar { strain, .. } = &mut self {
            *strain = measure;
        }
        self
    }

    /// The element with a name, by which results and [`Record`](crate::model::request::Record) refer to it.
    #[must_use]
    pub fn with_name(mut self, given: impl Into<String>) -> Self {
        let given = Some(given.into());
        match &mut self {
            Self::Bar { name, .. }
            | Self::Spring { name, .. }
            | Self::Beam { name, .. }
            | Self::RotationalSpring { name, .. } => *name = given,
            solid => solid.solid_mut().into_iter().for_each(|solid| solid.name.clone_from(&given)),
        }
        self
    }

    /// The name by which results refer to the element, where it has one.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Bar { name, .. }
            | Self::Spring { name, .. }
            | Self::Beam { name, .. }
            | Self::RotationalSpring { name, .. } => name.as_deref(),
            _ => self.solid().and_then(|(_, solid)| solid.name.as_deref()),
        }
    }

    /// The data of a solid, to be changed; `None` for other elements.
    pub fn solid_mut(&mut self) -> Option<&mut Solid> {
        match self {
            Self::Bar { .. }
            | Self::Spring { .. }
            | Self::Beam { .. }
            | Self::RotationalSpring { .. }
            | Self::Solid(_) => None,
            Self::Triangle3(solid)
            | Self::Triangle6(solid)
            | Self::Quadrilateral4(solid)
            | Self::Quadrilateral8(solid)
            | Self::Tetrahedron4(solid)
            | Self::Tetrahedron10(solid)
            | Self::Hexahedron8(solid)
            | Self::Hexahedron20(solid) => Some(solid),
        }
    }

    /// A solid of a kind.
    pub fn of_solid(kind: SolidKind, solid: Solid) -> Self {
        match kind {
            SolidKind::Triangle3 => Self::Triangle3(solid),
            SolidKind::Triangle6 => Self::Triangle6(solid),
            SolidKind::Quadrilateral4 => Self::Quadrilateral4(solid),
            SolidKind::Quadrilateral8 => Self::Quadrilateral8(solid),
            SolidKind::Tetrahedron4 => Self::Tetrahedron4(solid),
            SolidKind::Tetrahedron10 => Self::Tetrahedron10(solid),
            SolidKind::Hexahedron8 => Self::Hexahedron8(solid),
            SolidKind::Hexahedron20 => Self::Hexahedron20(solid),
        }
    }

    /// The kind and the data of a solid; `None` for other elements.
    pub fn solid(&self) -> Option<(SolidKind, &Solid)> {
        match self {
            Self::Bar { .. }
            | Self::Spring { .. }
            | Self::Beam { .. }
            | Self::RotationalSpring { .. }
            | Self::Solid(_) => None,
            Self::Triangle3(solid) => Some((SolidKind::Triangle3, solid)),
            Self::Triangle6(solid) => Some((SolidKind::Triangle6, solid)),
            Self::Quadrilateral4(solid) => Some((SolidKind::Quadrilateral4, solid)),
            Self::Quadrilateral8(solid) => Some((SolidKind::Quadrilateral8, solid)),
            Self::Tetrahedron4(solid) => Some((SolidKind::Tetrahedron4, solid)),
            Self::Tetrahedron10(solid) => Some((SolidKind::Tetrahedron10, solid)),
            Self::Hexahedron8(solid) => Some((SolidKind::Hexahedron8, solid)),
            Self::Hexahedron20(solid) => Some((SolidKind::Hexahedron20, solid)),
        }
    }

    /// Names of the nodes that the element joins; one where the other end is the ground.
    pub fn nodes(&self) -> &[String] {
        match self {
            Self::Bar { nodes, .. }
            | Self::Spring { nodes, .. }
            | Self::Beam { nodes, .. }
            | Self::RotationalSpring { nodes, .. } => nodes,
            _ => self.solid().map_or(&[], |(_, solid)| &solid.nodes),
        }
    }
}

fn rows<const DIMENSION: usize>(matrix: [[f64; DIMENSION]; DIMENSION]) -> Vec<Vec<f64>> {
    matrix.iter().map(|row| row.to_vec()).collect()
}
