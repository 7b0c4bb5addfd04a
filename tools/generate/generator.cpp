#include "tools/generate/generator.h"

#include <algorithm>

namespace pagoda::tools {

const std::vector<Generator>& generators() {
    static const std::vector<Generator> kGenerators{
        {"torus", "a closed, noisy surface like a scan", 1'000'000, generateTorus},
        {"powerplant", "boiler house, turbine hall and pipes, deep occlusion inside", 2'000'000,
         generatePowerplant},
        {"city", "streets and blocks, facades down to window sills", 2'000'000, generateCity},
        {"interior", "an office building: rooms, corridors, furniture", 1'000'000,
         generateInterior},
    };
    return kGenerators;
}

const Generator* findGenerator(std::string_view name) {
    const std::vector<Generator>& all = generators();
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const Generator& each) { return each.name == name; });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace pagoda::tools
