#include "tools/stress/stress_html.h"

namespace pagoda::tools {

std::string stressToHtml(const StressPlan&, const std::vector<StressCell>&, const std::string&,
                         const Figures&) {
    return {};
}

}  // namespace pagoda::tools
