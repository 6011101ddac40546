#include "guide_session.hpp"

#include "graticule/factors/camera_model.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/schema.hpp"

namespace graticule::apps {

GuideSession::GuideSession(const Registry& types, const TargetLayout& target,
                           const ImageSize& image, const SessionOptions& options)
    : types_(types),
      target_(target),
      image_(image),
      options_(options),
      session_(types, target, image, options) {
  Describe(&guidance_);
  thread_ = std::thread([this] { Work(); });
}

GuideSession::~GuideSession() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void GuideSession::Add(std::vector<DetectedCorner> corners) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    changes_.push_back({false, std::move(corners)});
    guidance_.is_busy = true;
  }
  wake_.notify_one();
}

void GuideSession::RemoveLast() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    changes_.push_back({true, {}});
    guidance_.is_busy = true;
  }
  wake_.notify_one();
}

void GuideSession::Settle() {
  std::unique_lock<std::mutex> lock(mutex_);
  idle_.wait(lock, [this] { return changes_.empty() && !is_working_; });
}

Guidance GuideSession::Now() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return guidance_;
}

bool GuideSession::IsNewer(std::size_t number, bool is_busy) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return guidance_.number != number || guidance_.is_busy != is_busy;
}

std::optional<GreyImage> GuideSession::Rectified(const GreyImage& image) {
  const Guidance now = Now();
  if (!now.is_solved) return std::nullopt;
  const std::lock_guard<std::mutex> lock(rectifier_mutex_);
  if (!rectifier_ || rectified_camera_ != now.camera.parameters) {
    const Camera camera(now.camera);
    rectifier_ = std::make_unique<Rectifier>(camera, Camera(RectifiedView(camera)));
    rectified_camera_ = now.camera.parameters;
  }
  return rectifier_->Image(image);
}

void GuideSession::Work() {
  for (;;) {
    std::unique_lock<std::mutex> lock(mutex_);
    wake_.wait(lock, [this] { return is_stopping_ || !changes_.empty(); });
    if (is_stopping_) return;
    const Change change = std::move(changes_.front());
    changes_.pop_front();
    is_working_ = true;
    lock.unlock();

    Guidance next;
    {
      const std::lock_guard<std::mutex> solving(session_mutex_);
      std::string message;
      // An exception must not cross the thread's end.
      try {
        message = Apply(change);
        Describe(&next);
      } catch (const std::exception& error) {
        message = error.what();
      }
      next.message = message;
    }

    lock.lock();
    is_working_ = false;
    next.number = guidance_.number + 1;
    next.is_busy = !changes_.empty();
    guidance_ = std::move(next);
    lock.unlock();
    idle_.notify_all();
  }
}

std::string GuideSession::Apply(const Change& change) {
  const auto note = [this] {
    steps_.push_back({session_.MaxEre().MaxPx(), session_.IsBootstrapping()});
  };
  if (!change.is_removal) {
    switch (session_.AddFrame(change.corners)) {
      case FrameVerdict::kTooFewCorners:
        return "too little of the target was seen: the frame was not kept";
      case FrameVerdict::kNotExplained:
        note();
        return "no pose of the target explains the last frame yet";
      case FrameVerdict::kUsed:
        note();
    }
    return "";
  }
  if (session_.FrameCount() == 0) return "there is no frame to remove";
  std::vector<TargetView> views = session_.Frames().views;
  views.pop_back();
  session_ = CalibrationSession(types_, target_, image_, options_);
  steps_.clear();
  for (const TargetView& view : views) {
    session_.AddFrame(view.corners);
    note();
  }
  return "the last frame was removed";
}

void GuideSession::Describe(Guidance* guidance) const {
  guidance->camera = GuessedCamera(image_);
  guidance->steps = steps_;
  guidance->suggestion = session_.Suggest();
  if (!session_.Solved()) return;
  const Calibration& solved = *session_.Solved();
  guidance->is_solved = true;
  guidance->camera = solved.state.cameras[0];
  guidance->is_bootstrapping = session_.IsBootstrapping();
  guidance->is_met = session_.AccuracyMet();
  guidance->rms_px = solved.rms_px;
  guidance->sigma_px = session_.SigmaPx();
  const Posterior& posterior = *session_.Uncertainty();
  // What a prior holds while bootstrapping, the frames do not.
  PosteriorOptions without_prior;
  without_prior.sigma_px = session_.SigmaPx();
  without_prior.loose = options_.suggest.loose;
  const std::vector<std::string> loose =
      session_.IsBootstrapping()
          ? ComputePosterior(session_.Frames(), solved.state, solved.use, without_prior)
                .unconstrained
          : posterior.unconstrained;
  const Fields fields = ParseFields(CameraModelOf(guidance->camera.model).fields);
  const std::vector<double> deviations = posterior.Deviations("camera:0");
  for (std::size_t i = 0; i < fields.size(); ++i) {
    GuideParameter parameter{fields[i].name, fields[i].unit, guidance->camera.parameters[i],
                             deviations[i], false};
    for (const std::string& name : loose)
      parameter.is_loose = parameter.is_loose || name.rfind(parameter.name + " of ", 0) == 0;
    guidance->parameters.push_back(parameter);
  }
  EreOptions ere = options_.suggest.ere;
  ere.columns = 17;
  ere.rows = 13;
  guidance->map = EreGrid(Camera(guidance->camera), ere).Map(posterior.OfCamera(0));
  MarkReached(session_.Frames(), 0, solved.use, &guidance->map);
}

}  // namespace graticule::apps
