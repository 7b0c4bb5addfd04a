// A program of someone else's that found Pagoda by find_package: prints a database's triangle
// count.
#include "ooc/base/error.h"
#include "ooc/store/database.h"

#include <cstdio>

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    try {
        const auto database = pagoda::ooc::Database::open(argv[1]);
        std::printf("%llu triangles\n",
                    static_cast<unsigned long long>(database.header().triangleCount));
        return 0;
    } catch (const pagoda::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
