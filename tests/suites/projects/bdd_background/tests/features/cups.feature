Feature: Cups
  Background:
    Given an arm over two cups
    And cup 1 was taken

  Scenario: the cup is held
    Then the arm is holding a cup

  Scenario: the red one
    Then the arm holds the red cup

  Scenario: the other is left
    Then cup 2 is left
    And the arm is up
