// The entry points of libFuzzer. One program for all targets: PAGODA_FUZZ_TARGET names the one.
#include "tests/fuzz/targets.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace {
const pagoda::fuzz::Target* chosen = nullptr;
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    const char* const name = std::getenv("PAGODA_FUZZ_TARGET");
    chosen = pagoda::fuzz::findTarget(name != nullptr ? name : "");
    if (chosen != nullptr) return 0;
    std::fputs("set PAGODA_FUZZ_TARGET to one of:", stderr);
    for (const auto& target : pagoda::fuzz::targets()) {
        std::fprintf(stderr, " %.*s", static_cast<int>(target.name.size()), target.name.data());
    }
    std::fputc('\n', stderr);
    std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    chosen->run(std::as_bytes(std::span(data, size)));
    return 0;
}
