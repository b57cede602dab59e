//! Takes the properties `translate`, `rotate` and `scale` of an element, makes them part of its transform:
//! the parser knows only that. After CSS Transforms 2, 5 and 6: they stand before `transform`, in this order.

use super::cascade::Cascade;
use super::document::{element, Element, Name, Values};
use super::transforms::{self, Frame};
use usvg::roxmltree::Node;

/// In the order in which they apply.
pub(super) const NAMES: [&str; 3] = ["translate", "rotate", "scale"];

/// An element that has some of them.
#[derive(Debug)]
pub(super) struct Individual {
    pub node: Element,
    /// Their values at rest, as transforms.
    own: [String; 3],
    transform: String,
    pub frame: Frame,
}

/// The value of one of them as a transform: `rotate: 1turn` is `rotate(1turn)`.
pub(super) fn as_function(name: &str, value: &str) -> String {
    match value.trim() {
        "" | "none" => String::new(),
        value => format!("{name}({})", value.trim_start_matches("z ")),
    }
}

impl Individual {
    pub(super) fn of<'a>(node: Node<'a, 'a>, cascade: &Cascade<'a>) -> Individual {
        let own = NAMES.map(|name| as_function(name, cascade.declared(node, name).unwrap_or_default()));
        let (transform, frame) = (cascade.value(node, "transform"), Frame::of(node, cascade));
        Individual { node: element(node), own, transform, frame }
    }

    /// Puts the whole transform in place of them.
    pub(super) fn compose(&self, values: &mut Values) {
        let values = values.entry(self.node).or_default();
        let mut whole = String::new();
        for (name, own) in NAMES.into_iter().zip(&self.own) {
            let moved = values.remove(&Name::Property(name.to_string()));
            whole = whole + moved.as_ref().unwrap_or(own) + " ";
        }
        let transform = Name::Property("transform".to_string());
        whole += transform.in_any_way(values).unwrap_or(&self.transform);
        values.insert(transform, transforms::still(&whole, &self.frame));
        if let Some(origin) = self.frame.origin() {
            values.insert(Name::Property("transform-origin".to_string()), origin);
        }
    }
}
