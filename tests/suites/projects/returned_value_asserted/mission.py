def survey(rover, legs):
    travelled = 0.0
    for leg in legs:
        rover.drive(leg)
        travelled += abs(rover.odometer())
    return {"travelled": travelled, "battery": rover.battery()}
