// seen_colours.h: what colour a stand-in's triangles need to look like the model from outside.
// A cell's mean colour counts what is hidden, and is shared by all that meets in the cell; this one
// is measured on parallel projections (visible_parts.h) of the model and of the stand-in.
#pragma once

#include "hlod/build/soup.h"

#include <span>
#include <vector>

namespace pagoda::hlod {

// Gives each opaque triangle of `standIn` one colour: the mean, over the pixels it covers in 26
// directions, of what `model` shows within 3 pixels. Both lie in one frame; `resolution` pixels
// along the diagonal of their box. Unseen and translucent triangles keep their colours; alpha and
// geometry stay.
void takeSeenColours(std::span<const SoupTriangle> model, const std::vector<bool>& isTranslucent,
                     int resolution, std::vector<SoupTriangle>& standIn);

}  // namespace pagoda::hlod
