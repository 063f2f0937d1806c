def grade(scale, parts):
    grades = {}
    for part in parts:
        scale.put(part)
        scale.press(2.0)
        grades[part] = "heavy" if scale.weight() > 5 else "light"
        scale.take()
    return grades
