#include "tests/drivers.h"

#include <cstdlib>
#include <iostream>

namespace skinbench {
namespace {

struct Opened {
    std::vector<std::unique_ptr<Backend>> owned;
    Backends byApi;
};

}  // namespace

bool underValidation() { return std::getenv("SKINBENCH_NO_VALIDATION") == nullptr; }

const Backends& openedBackends() {
    static const Opened opened = [] {
        Opened all;
        const BackendOptions options{.device = {}, .validation = underValidation()};
        auto keep = [&](Api api, Result<std::unique_ptr<Backend>> backend) {
            if (!backend) {
                all.byApi[api].missing = backend.error().text;
                std::cerr << "no driver: " << backend.error().text << "\n";
                return;
            }
            all.byApi[api].backend = backend->get();
            all.owned.push_back(std::move(*backend));
        };
        keep(Api::vulkan, openVulkan(options));
        keep(Api::opengl, openGl(options));
        return all;
    }();
    return opened.byApi;
}

bool anyDriver() {
    for (const auto& [api, open] : openedBackends())
        if (open.backend) return true;
    return false;
}

}  // namespace skinbench
