//! Filters against resvg's own pictures: the source layer is resvg's picture without the filter.

use super::*;
