Feature: Sorting a box by colour

  Scenario: The box goes from the conveyor to the target of its colour
    Given the system is initialised
    And the conveyor is initialised
    And the robot is at home within 0.02 cm in x
    And the robot is at home within 0.02 cm in y
    And the robot is at home within 0.02 cm in z
    And the box is on the conveyor within 0.01 cm in x
    And the box is on the conveyor within 0.01 cm in y
    And the box is on the conveyor within 0.01 cm in z
    When the program has finished
    Then the box is at its target within 0.02 cm in x
    And the box is at its target within 0.02 cm in y
    And the box is at its target within 0.02 cm in z
