// gl_fixture.h: one GL context for all tests of this program.
#pragma once

#include "viewer/gl_context.h"

#include <gtest/gtest.h>

namespace pagoda::viewer {

class GlTest : public ::testing::Test {
protected:
    static void SetUpTestSuite() {
        static const GlContext context = GlContext::headless();
        static_cast<void>(context);
    }
};

}  // namespace pagoda::viewer
