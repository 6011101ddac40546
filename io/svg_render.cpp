#include <cairo-pdf.h>
#include <cairo.h>
#include <dlfcn.h>
#include <librsvg/rsvg.h>

#include <cmath>
#include <memory>

#include "graticule/io/svg.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

// librsvg and what it brings, opened for the first picture: its fifty libraries cost a process as
// much to load as a small problem to solve.
struct Librsvg {
  void* library = dlopen("librsvg-2.so.2", RTLD_LAZY | RTLD_LOCAL);

#define GRATICULE_FIND(name) decltype(&::name) name = Find<decltype(&::name)>(#name);
  GRATICULE_FIND(cairo_create)
  GRATICULE_FIND(cairo_destroy)
  GRATICULE_FIND(cairo_image_surface_create)
  GRATICULE_FIND(cairo_paint)
  GRATICULE_FIND(cairo_set_source_rgb)
  GRATICULE_FIND(cairo_pdf_surface_create_for_stream)
  GRATICULE_FIND(cairo_pdf_surface_set_metadata)
  GRATICULE_FIND(cairo_show_page)
  GRATICULE_FIND(cairo_status_to_string)
  GRATICULE_FIND(cairo_surface_destroy)
  GRATICULE_FIND(cairo_surface_finish)
  GRATICULE_FIND(cairo_surface_status)
  GRATICULE_FIND(cairo_surface_write_to_png_stream)
  GRATICULE_FIND(g_error_free)
  GRATICULE_FIND(g_memory_input_stream_new_from_data)
  GRATICULE_FIND(g_object_unref)
  GRATICULE_FIND(rsvg_handle_get_intrinsic_dimensions)
  GRATICULE_FIND(rsvg_handle_get_intrinsic_size_in_pixels)
  GRATICULE_FIND(rsvg_handle_new_from_stream_sync)
  GRATICULE_FIND(rsvg_handle_render_document)
  GRATICULE_FIND(rsvg_handle_set_dpi)
#undef GRATICULE_FIND

 private:
  template <class Function>
  Function Find(const char* name) const {
    void* found = library ? dlsym(library, name) : nullptr;
    if (!found)
      throw Error(std::string("SVG to PNG: expected librsvg 2 (Debian: librsvg2-2): ") + dlerror(),
                  ErrorKind::kOther);
    return reinterpret_cast<Function>(found);
  }
};

const Librsvg& Lib() {
  static const Librsvg lib;
  return lib;
}

struct Release {
  void operator()(void* object) const { Lib().g_object_unref(object); }
  void operator()(GError* error) const { Lib().g_error_free(error); }
  void operator()(cairo_surface_t* surface) const { Lib().cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { Lib().cairo_destroy(context); }
};
template <class T>
using Owned = std::unique_ptr<T, Release>;

constexpr double kMaxSide = 32767;  // cairo's limit

[[noreturn]] void Refuse(const std::string& what, GError* error) {
  const Owned<GError> owned(error);
  throw Error("SVG to PNG: " + what + (error ? std::string(": ") + error->message : ""));
}

cairo_status_t Append(void* closure, const unsigned char* data, unsigned int length) {
  try {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
  } catch (...) {
    return CAIRO_STATUS_NO_MEMORY;
  }
  return CAIRO_STATUS_SUCCESS;
}

Owned<RsvgHandle> Parse(const std::string& svg) {
  const Owned<GInputStream> stream(Lib().g_memory_input_stream_new_from_data(
      svg.data(), static_cast<gssize>(svg.size()), nullptr));
  GError* error = nullptr;
  // Unlimited: libxml2 otherwise refuses an attribute above 10 MB, and a path is one attribute.
  Owned<RsvgHandle> handle(Lib().rsvg_handle_new_from_stream_sync(
      stream.get(), nullptr, RSVG_HANDLE_FLAG_UNLIMITED, nullptr, &error));
  if (!handle) Refuse("not an SVG document", error);
  Lib().rsvg_handle_set_dpi(handle.get(), 96);
  return handle;
}

double HeightOverWidth(RsvgHandle* handle) {
  double width = 0, height = 0;
  if (!Lib().rsvg_handle_get_intrinsic_size_in_pixels(handle, &width, &height)) {
    gboolean has_width, has_height, has_box;
    RsvgLength unused;
    RsvgRectangle box{};
    Lib().rsvg_handle_get_intrinsic_dimensions(handle, &has_width, &unused, &has_height, &unused,
                                               &has_box, &box);
    width = box.width;
    height = box.height;
  }
  if (!(width > 0 && height > 0)) Refuse("the document says no size", nullptr);
  return height / width;
}

}  // namespace

std::string PngFromSvg(const std::string& svg, int width_px) {
  const Owned<RsvgHandle> handle = Parse(svg);
  const double height_px = std::ceil(width_px * HeightOverWidth(handle.get()) - 1e-6);
  if (width_px < 1 || width_px > kMaxSide || height_px < 1 || height_px > kMaxSide)
    Refuse("a picture of " + std::to_string(width_px) + " pixels in width was asked for, 1 to " +
               std::to_string(static_cast<int>(kMaxSide)) + " a side are possible",
           nullptr);

  const Owned<cairo_surface_t> surface(
      Lib().cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, static_cast<int>(height_px)));
  const Owned<cairo_t> context(Lib().cairo_create(surface.get()));
  Lib().cairo_set_source_rgb(context.get(), 1, 1, 1);
  Lib().cairo_paint(context.get());
  const RsvgRectangle viewport{0, 0, static_cast<double>(width_px), height_px};
  GError* error = nullptr;
  if (!Lib().rsvg_handle_render_document(handle.get(), context.get(), &viewport, &error))
    Refuse("cannot draw", error);

  std::string png;
  const cairo_status_t status =
      Lib().cairo_surface_write_to_png_stream(surface.get(), Append, &png);
  if (status != CAIRO_STATUS_SUCCESS)
    throw Error(std::string("SVG to PNG: ") + Lib().cairo_status_to_string(status),
                ErrorKind::kOther);
  return png;
}

std::string PdfFromSvg(const std::string& svg, double width_mm, double height_mm) {
  constexpr double kPointsPerMm = 72 / 25.4;
  const Owned<RsvgHandle> handle = Parse(svg);
  const double width = width_mm * kPointsPerMm, height = height_mm * kPointsPerMm;
  if (!(width > 0 && height > 0) || width > kMaxSide || height > kMaxSide)
    Refuse("a page without size, or too large", nullptr);
  std::string pdf;
  const Owned<cairo_surface_t> surface(
      Lib().cairo_pdf_surface_create_for_stream(Append, &pdf, width, height));
  // Without the time of day: the same picture is the same file.
  Lib().cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE,
                                       "2000-01-01T00:00:00Z");
  {
    const Owned<cairo_t> context(Lib().cairo_create(surface.get()));
    const RsvgRectangle page{0, 0, width, height};
    GError* error = nullptr;
    if (!Lib().rsvg_handle_render_document(handle.get(), context.get(), &page, &error))
      Refuse("cannot draw", error);
    Lib().cairo_show_page(context.get());
  }
  Lib().cairo_surface_finish(surface.get());
  const cairo_status_t status = Lib().cairo_surface_status(surface.get());
  if (status != CAIRO_STATUS_SUCCESS)
    throw Error(std::string("SVG to PDF: ") + Lib().cairo_status_to_string(status),
                ErrorKind::kOther);
  return pdf;
}

}  // namespace graticule
