#include "tools/stress/stress_plots.h"

namespace pagoda::tools {

Figures drawStressFigures(const std::vector<StressCell>&) {
    return {};
}

}  // namespace pagoda::tools
