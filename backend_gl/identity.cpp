// Which physical device a context runs on.
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <array>
#include <filesystem>
#include <format>
#include <optional>
#include <string_view>

#include "backend_gl/context.h"
#include "common/frame/devices.h"

namespace skinbench {
namespace {

bool offers(EGLDeviceEXT device, std::string_view extension) {
    if (device == EGL_NO_DEVICE_EXT || !eglQueryDeviceStringEXT) return false;
    const char* words = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    return words && std::format(" {} ", words).contains(std::format(" {} ", extension));
}

std::string uuidOfDevice(EGLDeviceEXT device) {
    if (!offers(device, "EGL_EXT_device_persistent_id")) return "";
    // glad looks for the extension among those of displays only.
    const auto query = reinterpret_cast<PFNEGLQUERYDEVICEBINARYEXTPROC>(eglGetProcAddress("eglQueryDeviceBinaryEXT"));
    std::array<uint8_t, 16> uuid{};
    constexpr EGLint kBytes = uuid.size();
    EGLint size = 0;
    if (!query || !query(device, EGL_DEVICE_UUID_EXT, kBytes, uuid.data(), &size) || size != kBytes) return "";
    return uuidText(uuid);
}

// The kernel's folder of a device file is named as its address where it is on a PCI bus.
std::string pciOfFile(const std::string& file) {
    struct stat status {};
    if (file.empty() || stat(file.c_str(), &status) != 0 || !S_ISCHR(status.st_mode)) return "";
    std::error_code failed;
    const auto folder = std::filesystem::canonical(
        std::format("/sys/dev/char/{}:{}/device", major(status.st_rdev), minor(status.st_rdev)), failed);
    return failed ? "" : pciText(folder.filename().string());
}

uint32_t vendorOf(std::string_view words) {
    if (words.starts_with("NVIDIA")) return kVendorNvidia;
    if (words.starts_with("AMD") || words.starts_with("ATI")) return kVendorAmd;
    return words.starts_with("Intel") ? kVendorIntel : 0;
}

}  // namespace

EGLDeviceEXT eglDeviceOf(EGLDisplay display) {
    EGLAttrib device = 0;
    if (!eglQueryDisplayAttribEXT || !eglQueryDisplayAttribEXT(display, EGL_DEVICE_EXT, &device))
        return EGL_NO_DEVICE_EXT;
    return reinterpret_cast<EGLDeviceEXT>(device);
}

std::string drmFile(EGLDeviceEXT device) {
    if (!offers(device, "EGL_EXT_device_drm")) return "";
    const char* file = eglQueryDeviceStringEXT(device, EGL_DRM_DEVICE_FILE_EXT);
    return file ? file : "";
}

std::optional<std::array<uint8_t, 16>> contextUuid() {
    GLint count = 0;
    std::array<uint8_t, 16> uuid{};
    if (!GLAD_GL_EXT_memory_object || !glGetUnsignedBytei_vEXT) return std::nullopt;
    glGetIntegerv(GL_NUM_DEVICE_UUIDS_EXT, &count);
    if (count != 1) return std::nullopt;
    glGetUnsignedBytei_vEXT(GL_DEVICE_UUID_EXT, 0, uuid.data());
    return uuid;
}

void fillIdentity(EGLDisplay display, DeviceCaps& caps) {
    const EGLDeviceEXT device = eglDeviceOf(display);
    caps.uuid = uuidOfDevice(device);
    if (caps.uuid.empty()) caps.uuid = uuidText(contextUuid().value_or(std::array<uint8_t, 16>{}));
    caps.vendor = vendorOf(caps.driver);
    if (!caps.software) caps.pci = pciOfFile(drmFile(device));
}

}  // namespace skinbench
