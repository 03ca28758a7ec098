; Satellites turn, switch on one instrument at a time, calibrate it and take pictures.
;@ skill turn-to 0 turn-to ?s ?new
;@ skill switch-on 0 switch-on ?i
;@ skill switch-off 0 switch-off ?i
;@ skill calibrate 0 calibrate ?i
;@ skill take-image 0 take-image ?i ?m
(define (domain satellite)
 (:requirements :strips :typing)
 (:types satellite instrument mode direction)
 (:predicates (on-board ?i - instrument ?s - satellite) (supports ?i - instrument ?m - mode)
  (pointing ?s - satellite ?d - direction) (power-available ?s - satellite) (power-on ?i - instrument)
  (calibrated ?i - instrument) (have-image ?d - direction ?m - mode)
  (calibration-target ?i - instrument ?d - direction))
 (:action turn-to
  :parameters (?s - satellite ?new ?old - direction)
  :precondition (and (pointing ?s ?old))
  :effect (and (pointing ?s ?new) (not (pointing ?s ?old))))
 (:action switch-on
  :parameters (?i - instrument ?s - satellite)
  :precondition (and (on-board ?i ?s) (power-available ?s))
  :effect (and (power-on ?i) (not (calibrated ?i)) (not (power-available ?s))))
 (:action switch-off
  :parameters (?i - instrument ?s - satellite)
  :precondition (and (on-board ?i ?s) (power-on ?i))
  :effect (and (power-available ?s) (not (power-on ?i))))
 (:action calibrate
  :parameters (?s - satellite ?i - instrument ?d - direction)
  :precondition (and (on-board ?i ?s) (calibration-target ?i ?d) (pointing ?s ?d) (power-on ?i))
  :effect (and (calibrated ?i)))
 (:action take-image
  :parameters (?s - satellite ?d - direction ?i - instrument ?m - mode)
  :precondition (and (on-board ?i ?s) (supports ?i ?m) (pointing ?s ?d) (power-on ?i) (calibrated ?i))
  :effect (and (have-image ?d ?m))))
