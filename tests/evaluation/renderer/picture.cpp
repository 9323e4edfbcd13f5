#include "renderer/picture.h"

#include <OpenImageIO/imageio.h>

#include <glm/gtc/constants.hpp>
#include <utility>

#include "renderer/gloss.h"
#include "renderer/parallel.h"

namespace lpv::evaluation {

namespace {

/// Rays through places in the picture; rays of one unit along the view, so that near and far are depths.
struct View {
  View(const Camera& given, const glm::ivec2& pixels)
      : camera(given), size(pixels), forward(glm::normalize(given.target - given.eye)) {}

  /// x, y in pixels from the upper left corner.
  std::optional<Hit> seen(const TracedScene& scene, double x, double y) const {
    const glm::dvec3 ray = camera.rayDirection(x / size.x, y / size.y, double(size.x) / size.y);
    const double perDepth = 1.0 / glm::dot(ray, forward);
    return scene.seen(camera.eye, ray, camera.near * perDepth, camera.far * perDepth);
  }

  Camera camera;
  glm::ivec2 size;
  glm::dvec3 forward;
};

Picture blank(const glm::ivec2& size, const std::vector<int>& levels) {
  Picture p;
  p.width = size.x;
  p.height = size.y;
  p.levels = levels;
  const auto pixels = std::size_t(size.x) * std::size_t(size.y);
  for (auto* layers : {&p.radiance, &p.radianceError, &p.irradiance, &p.irradianceError}) {
    layers->assign(levels.size(), std::vector<glm::vec3>(pixels, glm::vec3(0.0F)));
  }
  for (auto* layer :
       {&p.direct, &p.unoccluded, &p.unoccludedError, &p.position, &p.normal, &p.flatNormal, &p.albedo, &p.material}) {
    layer->assign(pixels, glm::vec3(0.0F));
  }
  p.object.assign(pixels, 0.0F);
  return p;
}

/// Everything of the ray through the pixel's centre.
void renderCentre(Picture& picture, std::size_t i, const TracedScene& scene, const PathTracer& tracer, const Hit& hit,
                  const Sampling& sampling, const ClosedForm* exact, const glm::dvec3* eye) {
  picture.object[i] = float(hit.object + 1);
  const Receiver receiver = receiverAt(hit);
  picture.position[i] = hit.position;
  picture.normal[i] = receiver.normal;
  picture.flatNormal[i] = receiver.flatNormal;
  if (scene.objects()[hit.object].emits) {
    for (auto& layer : picture.radiance) layer[i] = scene.emitted(hit);
    return;
  }
  const IrradianceEstimate e = estimateIrradiance(tracer, receiver, sampling, std::uint32_t(i), exact);
  const glm::dvec3 albedo = scene.albedo(hit);
  picture.albedo[i] = albedo;
  picture.direct[i] = e.direct;
  picture.unoccluded[i] = e.unoccluded;
  picture.unoccludedError[i] = e.unoccludedError;
  for (std::size_t level = 0; level < e.mean.size(); ++level) {
    picture.irradiance[level][i] = e.mean[level];
    picture.irradianceError[level][i] = e.error[level];
    picture.radiance[level][i] = albedo * e.mean[level] / glm::pi<double>();
    picture.radianceError[level][i] = albedo * e.error[level] / glm::pi<double>();
  }
  if (eye == nullptr || !isGlossy(scene, hit)) return;
  const Finish finish = scene.finish(hit);
  picture.material[i] = {finish.roughness, finish.metalness, 1.0};
  const GlossTracer gloss(scene, tracer, hit, *eye);
  const GlossEstimate lobe = estimateGloss(gloss, e.mean.size(), sampling, std::uint32_t(i));
  for (std::size_t level = 0; level < e.mean.size(); ++level) {
    const glm::dvec3 beneath = gloss.diffuse() * glm::dvec3(picture.radianceError[level][i]);
    picture.radiance[level][i] = gloss.diffuse() * glm::dvec3(picture.radiance[level][i]) + lobe.mean[level];
    picture.radianceError[level][i] = glm::sqrt(beneath * beneath + lobe.error[level] * lobe.error[level]);
  }
}

/// To radiance by the albedo, per level.
void addLobe(std::vector<glm::dvec3>& radiance, const GlossTracer& tracer, Sampler& sampler) {
  const std::vector<glm::dvec3> lobe = tracer.sample(sampler);
  for (std::size_t level = 0; level < radiance.size(); ++level)
    radiance[level] = tracer.diffuse() * radiance[level] + lobe[level];
}

/// Radiance as the mean over the pixel.
void renderBox(Picture& picture, int x, int y, const TracedScene& scene, const PathTracer& tracer, const View& view,
               const Sampling& sampling, bool gloss) {
  const std::size_t i = picture.index(x, y);
  std::vector<Replicates> sums(picture.levels.size());
  for (int replicate = 0; replicate < sampling.replicates; ++replicate) {
    Sampler sampler(hashed(hashed(~sampling.seed + std::uint32_t(i)) + std::uint32_t(replicate)));
    std::vector<glm::dvec3> mean(picture.levels.size(), glm::dvec3(0.0));
    for (int k = 0; k < sampling.perReplicate(); ++k) {
      sampler.start(std::uint32_t(k));
      const glm::dvec2 within = sampler.pair();
      const std::optional<Hit> hit = view.seen(scene, x + within.x, y + within.y);
      if (!hit) continue;
      const glm::dvec3 emitted = scene.emitted(*hit);
      const glm::dvec3 reflectance = scene.albedo(*hit) / glm::pi<double>();
      const bool lit = reflectance != glm::dvec3(0.0);
      const PathSample path = lit ? tracer.sample(receiverAt(*hit), sampler) : PathSample();
      std::vector<glm::dvec3> seen(mean.size(), glm::dvec3(0.0));
      for (std::size_t level = 0; level < mean.size(); ++level) {
        if (lit) seen[level] = reflectance * path.irradiance[level];
      }
      if (gloss && isGlossy(scene, *hit)) addLobe(seen, GlossTracer(scene, tracer, *hit, view.camera.eye), sampler);
      for (std::size_t level = 0; level < mean.size(); ++level) mean[level] += emitted + seen[level];
    }
    for (std::size_t level = 0; level < mean.size(); ++level)
      sums[level].add(mean[level] / double(sampling.perReplicate()));
  }
  for (std::size_t level = 0; level < sums.size(); ++level) {
    picture.radiance[level][i] = sums[level].mean();
    picture.radianceError[level][i] = sums[level].error();
  }
}

void append(std::vector<std::string>& names, const char* prefix, const char* axes) {
  for (int axis = 0; axis < 3; ++axis) names.push_back(std::string(prefix) + (*prefix ? "." : "") + axes[axis]);
}

}  // namespace

Picture renderPicture(const TracedScene& scene, const PathTracer& tracer, const Camera& camera, const glm::ivec2& size,
                      PixelFilter filter, const Sampling& sampling, const ClosedForm* exact, bool gloss) {
  const View view(camera, size);
  Picture picture = blank(size, tracer.levels());
  parallelFor(size.x * size.y, sampling.threads, [&](int pixel) {
    const int x = pixel % size.x;
    const int y = pixel / size.x;
    const std::optional<Hit> hit = view.seen(scene, x + 0.5, y + 0.5);
    if (hit)
      renderCentre(picture, std::size_t(pixel), scene, tracer, *hit, sampling, exact, gloss ? &camera.eye : nullptr);
    if (filter == PixelFilter::kBox) renderBox(picture, x, y, scene, tracer, view, sampling, gloss);
  });
  return picture;
}

Status writeExr(const std::string& path, const Picture& p, std::size_t level) {
  const std::vector<std::pair<const char*, const std::vector<glm::vec3>*>> layers = {{"", &p.radiance[level]},
                                                                                     {"se", &p.radianceError[level]},
                                                                                     {"E", &p.irradiance[level]},
                                                                                     {"Ese", &p.irradianceError[level]},
                                                                                     {"D", &p.direct},
                                                                                     {"U", &p.unoccluded},
                                                                                     {"Use", &p.unoccludedError},
                                                                                     {"P", &p.position},
                                                                                     {"N", &p.normal},
                                                                                     {"G", &p.flatNormal},
                                                                                     {"A", &p.albedo},
                                                                                     {"M", &p.material}};
  std::vector<std::string> names;
  for (const auto& [name, layer] : layers) {
    const bool vector = *name == 'P' || *name == 'N' || *name == 'G';
    append(names, name, vector ? "XYZ" : "RGB");
  }
  names.emplace_back("object");
  std::vector<float> values;
  for (std::size_t i = 0; i < p.object.size(); ++i) {
    for (const auto& [name, layer] : layers) values.insert(values.end(), {(*layer)[i].x, (*layer)[i].y, (*layer)[i].z});
    values.push_back(p.object[i]);
  }
  OIIO::ImageSpec spec(p.width, p.height, int(names.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames = names;
  spec.attribute("compression", "zip");
  const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
  if (!out || !out->open(path, spec) || !out->write_image(OIIO::TypeDesc::FLOAT, values.data()) || !out->close()) {
    return invalid("output", path + " cannot be written: " + (out ? out->geterror() : OIIO::geterror()));
  }
  return {};
}

}  // namespace lpv::evaluation
