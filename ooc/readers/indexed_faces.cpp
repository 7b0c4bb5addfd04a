#include "ooc/readers/indexed_faces.h"

namespace pagoda::ooc {

OpacitySplitter::OpacitySplitter(TriangleSink& sink, bool hasColours, bool hasNormals)
    : sink_(sink), object_(sink.addObject({})), opaque_(sink, hasColours, hasNormals) {
    opaque_.setTarget(object_, sink.addMaterial({}));
}

TriangleBatcher& OpacitySplitter::translucent() {
    if (!translucent_) {
        translucent_.emplace(sink_, opaque_.hasColours(), opaque_.hasNormals());
        MaterialInfo material;
        material.isTranslucent = true;
        translucent_->setTarget(object_, sink_.addMaterial(material));
    }
    return *translucent_;
}

void OpacitySplitter::finish() {
    opaque_.finish();
    if (translucent_) translucent_->finish();
}

}  // namespace pagoda::ooc
