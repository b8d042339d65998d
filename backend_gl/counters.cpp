#include "backend_gl/counters.h"

namespace skinbench {

namespace {

struct Statistic {
    GLenum target;
    std::optional<uint64_t> Counters::*value;
};

constexpr std::array<Statistic, 7> kStatistics = {{
    {GL_VERTICES_SUBMITTED, &Counters::inputVertices},
    {GL_PRIMITIVES_SUBMITTED, &Counters::inputPrimitives},
    {GL_VERTEX_SHADER_INVOCATIONS, &Counters::vertexInvocations},
    {GL_CLIPPING_INPUT_PRIMITIVES, &Counters::clippingInvocations},
    {GL_CLIPPING_OUTPUT_PRIMITIVES, &Counters::clippingPrimitives},
    {GL_FRAGMENT_SHADER_INVOCATIONS, &Counters::fragmentInvocations},
    {GL_COMPUTE_SHADER_INVOCATIONS, &Counters::computeInvocations},
}};

bool counts(PassKind kind, GLenum target) {
    switch (target) {
        case GL_COMPUTE_SHADER_INVOCATIONS:
            return kind == PassKind::dispatch;
        case GL_VERTICES_SUBMITTED:
        case GL_PRIMITIVES_SUBMITTED:
        case GL_VERTEX_SHADER_INVOCATIONS:
            return kind == PassKind::drawIndexed;
        default:
            return kind != PassKind::dispatch;
    }
}

}  // namespace

GlCounterQueries::GlCounterQueries() {
    for (size_t i = 0; i < ids_.size(); ++i) glCreateQueries(kStatistics[i].target, 1, &ids_[i]);
}

GlCounterQueries::~GlCounterQueries() { glDeleteQueries(static_cast<GLsizei>(ids_.size()), ids_.data()); }

void GlCounterQueries::begin() const {
    for (size_t i = 0; i < ids_.size(); ++i) glBeginQuery(kStatistics[i].target, ids_[i]);
}

void GlCounterQueries::end(PassKind kind, Counters& sum) const {
    for (const Statistic& statistic : kStatistics) glEndQuery(statistic.target);
    for (size_t i = 0; i < ids_.size(); ++i) {
        if (!counts(kind, kStatistics[i].target)) continue;
        GLuint64 value = 0;
        glGetQueryObjectui64v(ids_[i], GL_QUERY_RESULT, &value);
        std::optional<uint64_t>& total = sum.*kStatistics[i].value;
        total = total.value_or(0) + value;
    }
}

}  // namespace skinbench
