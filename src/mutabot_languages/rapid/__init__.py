"""RAPID: programs of ABB robots, ``.mod``, ``.sys``, ``.prg`` and their RobotWare 7 names."""
